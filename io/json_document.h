// io/json_document.h -- strict JSON that knows where every value and every key stands.
//
// JsonDocument holds a parsed text, JsonNode is a view of one value in it: it knows its JSON
// pointer and its line and column, and turns the value into a checked number, word or vector.
// Nothing is converted silently: no 1.5 as an integer, no -1 as an unsigned number, no unknown or
// repeated key. An integer may be written as 1000, 1000.0 or 1e3 (JSON Schema counts all three as
// integers).
//
// Refused while reading: files above 32 MiB, words, numbers and texts above 1 MiB, more values than
// 128 MiB of memory hold (with the text; 2 million in one list, a state of 45 000 particles),
// folders, devices and pipes (never opened for reading), nesting deeper than 64, byte-order marks,
// NUL bytes, bad UTF-8, comments, repeated keys, anything after the value, numbers beyond double
// precision.
//
// Errors: Error(missing) for a file that cannot be read, Error(input) for everything in it, e.g.
//   quickstart.json:14:17: /steps/2/stress: must be > 0 [sigma0], got -1
//   quickstart.json:9:7: /suspension/volum_fraction: unknown key, did you mean "volume_fraction"?
//   ...
// Lines and columns count from 1, columns in characters.
#pragma once
#include "engine/error.h"
#include "engine/types.h"
#include "io/json_override.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sigmaflow::io {

/// Allowed numbers: low <= x <= high, each end open if so marked. Never contains NaN or infinity.
struct Range {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    bool low_open = false, high_open = false;

    bool contains(double value) const;
    /// "> 0 and <= 0.64"; "finite" if there are no limits.
    std::string text() const;
};

constexpr Range any_number()
{
    return {};
}
constexpr Range at_least(double low)
{
    return {.low = low};
}
constexpr Range at_most(double high)
{
    return {.high = high};
}
constexpr Range above(double low)
{
    return {.low = low, .low_open = true};
}
constexpr Range below(double high)
{
    return {.high = high, .high_open = true};
}
constexpr Range between(double low, double high)
{
    return {low, high, false, false};
}
/// low < x <= high
constexpr Range above_to(double low, double high)
{
    return {low, high, true, false};
}
/// low <= x < high
constexpr Range from_below(double low, double high)
{
    return {low, high, false, true};
}

/// Allowed number of elements of an array.
struct Length {
    std::size_t minimum = 0;
    std::size_t maximum = std::numeric_limits<std::size_t>::max();

    static constexpr Length exactly(std::size_t n) { return {n, n}; }
    /// "3", "1 to 5", "at least 2"
    std::string text() const;
};

struct JsonValue;
struct JsonTree;

/// View of one value. Valid as long as its document lives.
class JsonNode {
public:
    const std::string& pointer() const { return pointer_; }  // "" for the whole document

    bool is_object() const;
    bool is_array() const;
    bool is_number() const;
    bool is_text() const;

    // objects
    bool has(std::string_view key) const;
    JsonNode member(std::string_view key) const;  // error if it does not exist
    std::optional<JsonNode> find(std::string_view key) const;
    std::vector<std::string> keys() const;  // in the order of the file
    /// Refuses every key that is not in the list and names the nearest known one; all of them at
    /// once.
    void refuse_other_keys(std::span<const std::string_view> known) const;
    /// Is there a key that is not in the list and was probably meant to be `key`?
    bool misspells(std::string_view key, std::span<const std::string_view> known) const;
    void refuse_other_keys(std::initializer_list<std::string_view> known) const;

    // arrays
    std::size_t size() const;  // of an array
    JsonNode element(std::size_t index) const;
    std::vector<JsonNode> elements(Length length = {}) const;

    // values
    double number(Range range = {}, std::string_view unit = "") const;
    std::int64_t integer(std::int64_t low, std::int64_t high) const;
    std::uint64_t unsigned_integer() const;  // [0, 2^64)
    bool boolean() const;
    std::string text(std::size_t longest = 4096) const;
    /// Index of the word in the list of allowed words.
    std::size_t word(std::span<const std::string_view> allowed) const;
    std::size_t word(std::initializer_list<std::string_view> allowed) const;
    std::vector<double> numbers(Length length = {}, Range range = {},
                                std::string_view unit = "") const;
    Vec3 vector(Range range = {}, std::string_view unit = "") const;  // [x, y, z]
    Mat3 matrix() const;                                              // [[..3], [..3], [..3]]
    std::vector<Vec3> vectors(Length length = {}, Range range = {},
                              std::string_view unit = "") const;  // [[x, y, z], ...]

    /// What is written in the file, shortened: -1, "heun", an object, an array of 7 elements.
    std::string shown() const;
    /// Error(input) "<file>:<line>:<column>: <pointer>: <problem>" at this value.
    Error error(const std::string& problem) const;
    /// The same at the key of a member of this object.
    Error error_at_key(std::string_view key, const std::string& problem) const;
    /// Error "<requirement>, got <value>".
    Error wrong(const std::string& requirement) const;

private:
    friend class JsonDocument;
    JsonNode(const JsonTree* tree, const JsonValue* value, std::string pointer)
        : tree_(tree), value_(value), pointer_(std::move(pointer))
    {
    }
    double checked_number(const JsonValue& value, Range range, std::string_view unit,
                          std::size_t index) const;

    const JsonTree* tree_;
    const JsonValue* value_;
    std::string pointer_;
};

class JsonDocument {
public:
    /// Errors: missing (no such file, a folder, a device, not readable), input (content).
    static JsonDocument read(const std::filesystem::path& path,
                             const std::vector<Override>& overrides = {});
    /// `name` stands for the file in error messages.
    static JsonDocument parse(std::string text, std::string name,
                              const std::vector<Override>& overrides = {});

    JsonNode root() const&;
    JsonNode root() && = delete;  // the node would outlive its document

    const std::string& text() const;

private:
    explicit JsonDocument(std::shared_ptr<const JsonTree> tree) : tree_(std::move(tree)) {}
    std::shared_ptr<const JsonTree> tree_;
};

/// The known word that the given one was probably meant to be: edit distance (with neighbouring
/// letters swapped counting once) of at most 2, or one the beginning of the other.
std::optional<std::string> nearest_word(std::string_view word,
                                        std::span<const std::string_view> known);

/// The shortest decimal text that reads back as the same number.
std::string number_text(double value);

/// Text in double quotes, control characters escaped, shortened to `longest` bytes.
std::string in_quotes(std::string_view text, std::size_t longest = 60);

}
