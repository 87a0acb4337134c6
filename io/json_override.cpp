#include "io/json_override.h"

#include "engine/error.h"
#include "io/json_document.h"
#include "io/json_parse.h"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

namespace sigmaflow::io {

namespace {

/// "/a/b~1c" as a, b/c. RFC 6901: ~1 stands for /, ~0 for ~.
std::vector<std::string> keys_of(const std::string& pointer)
{
    std::vector<std::string> keys;
    for (char c : pointer) {
        if (c == '/')
            keys.emplace_back();
        else
            keys.back() += c;
    }
    for (std::string& key : keys)
        for (std::size_t at = key.find('~'); at != std::string::npos; at = key.find('~', at + 1))
            key.replace(at, 2, key.substr(at + 1, 1) == "1" ? "/" : "~");
    return keys;
}

void shift(JsonValue& value, std::uint32_t distance)
{
    value.offset += distance;
    if (auto* array = std::get_if<std::unique_ptr<JsonValue::Array>>(&value.data))
        for (JsonValue& element : **array) shift(element, distance);
    if (auto* object = std::get_if<std::unique_ptr<JsonValue::Object>>(&value.data))
        for (JsonMember& member : **object) {
            member.offset += distance;
            shift(member.value, distance);
        }
}

std::string as_json(const std::string& text)
{
    try {
        JsonDocument::parse(text, "");
        return text;
    } catch (const Error&) {
        return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    }
}

/// The place for the value, made if it is a new member.
JsonValue& place_of(JsonTree& tree, const Override& given)
{
    JsonValue* value = &tree.root;
    std::string pointer;
    const std::vector<std::string> keys = keys_of(given.pointer);
    for (std::size_t k = 0; k < keys.size(); ++k) {
        const std::string& key = keys[k];
        const auto refuse = [&](const std::string& problem) {
            throw Error(ErrorKind::input, given.option + ": " + json_pointer(pointer, key),
                        problem);
        };
        if (auto* object = std::get_if<std::unique_ptr<JsonValue::Object>>(&value->data)) {
            auto& members = **object;
            auto it = std::find_if(members.begin(), members.end(),
                                   [&](const JsonMember& m) { return m.key == key; });
            if (it == members.end()) {
                if (k + 1 < keys.size()) refuse("does not exist in the file");
                it = members.insert(
                    members.end(),
                    JsonMember{static_cast<std::uint32_t>(tree.text.size()), key, {}});
            }
            value = &it->value;
        } else if (auto* array = std::get_if<std::unique_ptr<JsonValue::Array>>(&value->data)) {
            std::size_t index = 0;
            const char* end = key.data() + key.size();
            const auto parsed = std::from_chars(key.data(), end, index);
            if (parsed.ec != std::errc() || parsed.ptr != end || index >= (*array)->size())
                refuse("does not exist in the file: there are " + std::to_string((*array)->size()) +
                       " elements, counted from 0");
            value = &(**array)[index];
        } else {
            refuse("does not exist in the file: " + (pointer.empty() ? "it" : pointer) +
                   " is neither an object nor an array");
        }
        pointer = json_pointer(pointer, key);
    }
    return *value;
}

}

Override parse_override(const std::string& option, const std::string& text)
{
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals < 2 || text.front() != '/')
        throw Error(
            ErrorKind::usage, option,
            "must be a JSON pointer and a value, as /steps/1/stress=3, got " + in_quotes(text));
    return {option, text.substr(0, equals), text.substr(equals + 1)};
}

void apply_override(JsonTree& tree, const Override& given)
{
    JsonTree added{given.option, as_json(given.value), {}, {}};
    parse_json(added);
    JsonValue& place = place_of(tree, given);
    const std::size_t begin = tree.text.size() + 1;
    shift(added.root, static_cast<std::uint32_t>(begin));
    tree.text += "\n" + added.text;
    tree.additions.push_back({given.option, begin});
    place = std::move(added.root);
}

}
