// io/json_parse.h -- the tree behind JsonDocument (used by json_document.cpp only).
#pragma once
#include <cstdint>
#include <memory>
#include <string>
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

struct JsonTree {
    std::string name, text;
    JsonValue root;
};

inline constexpr std::size_t largest_json_file = std::size_t{64} << 20;  // bytes
inline constexpr int deepest_json = 64;
inline constexpr std::size_t most_json_values = 10'000'000;

/// Fills tree.root from tree.text. Errors: input.
void parse_json(JsonTree& tree);

/// "name:line:column" of a byte of the text.
std::string json_location(const JsonTree& tree, std::size_t offset);

/// End of the token that begins at `offset`.
std::size_t json_token_end(const std::string& text, std::size_t offset);

/// A step further in a JSON pointer, with ~ and / escaped.
std::string json_pointer(const std::string& parent, std::string_view key);

}
