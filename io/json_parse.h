// io/json_parse.h -- the tree behind JsonDocument (used by json_document.cpp only).
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace sigmaflow::io {

struct JsonMember;

/// One value. `offset` is the byte at which it begins in the text.
struct JsonValue {
    using Array = std::vector<JsonValue>;
    using Object = std::vector<JsonMember>;  // in the order of the file

    std::uint32_t offset = 0;
    std::variant<std::monostate, bool, double, std::unique_ptr<std::string>, std::unique_ptr<Array>,
                 std::unique_ptr<Object>>
        data;
};

struct JsonMember {
    std::uint32_t offset;  // of the key
    std::string key;
    JsonValue value;
};

// Null if the value is of another kind.
inline const JsonValue::Object* object_of(const JsonValue& value)
{
    const auto* data = std::get_if<std::unique_ptr<JsonValue::Object>>(&value.data);
    return data ? data->get() : nullptr;
}

inline const JsonValue::Array* array_of(const JsonValue& value)
{
    const auto* data = std::get_if<std::unique_ptr<JsonValue::Array>>(&value.data);
    return data ? data->get() : nullptr;
}

inline const std::string* text_of(const JsonValue& value)
{
    const auto* data = std::get_if<std::unique_ptr<std::string>>(&value.data);
    return data ? data->get() : nullptr;
}

/// A value that does not stand in the file (io/json_override.h): its text, after that of the file.
struct JsonAddition {
    std::string option;
    std::size_t begin;
};

struct JsonTree {
    std::string name, text;
    JsonValue root;
    std::vector<JsonAddition> additions;  // the last one last
};

// A hostile text of some bytes per value needs fifty times its size as a tree: both are limited.
inline constexpr std::size_t largest_json_file = std::size_t{32} << 20;   // bytes
inline constexpr std::size_t largest_json_tree = std::size_t{128} << 20;  // bytes, text included
inline constexpr std::size_t longest_json_token = std::size_t{1} << 20;   // bytes
inline constexpr int deepest_json = 64;

/// Fills tree.root from tree.text. Errors: input.
void parse_json(JsonTree& tree);

/// "name:line:column" of a byte of the text, or the option that it stands for.
std::string json_location(const JsonTree& tree, std::size_t offset);

/// End of the token that begins at `offset`.
std::size_t json_token_end(const std::string& text, std::size_t offset);

/// "heun, euler"
std::string one_of(std::span<const std::string_view> words);

/// A step further in a JSON pointer, with ~ and / escaped.
std::string json_pointer(const std::string& parent, std::string_view key);

}
