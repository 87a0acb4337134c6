#include "io/json_parse.h"

#include "engine/error.h"
#include "io/json_document.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

namespace sigmaflow::io {

namespace {

bool is_space(char c)
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

bool is_structure(char c)
{
    return c == '{' || c == '}' || c == '[' || c == ']' || c == ',' || c == ':';
}

/// At most `longest` bytes of a text, every one that is not UTF-8 replaced by U+FFFD.
std::string readable(const std::string& text, std::size_t longest)
{
    using nlohmann::json;
    const auto replace = json::error_handler_t::replace;
    return json::parse(json(text.substr(0, longest)).dump(-1, ' ', false, replace));
}

std::size_t line_of(const std::string& text, std::size_t offset)
{
    return 1 + static_cast<std::size_t>(std::count(text.begin(), text.begin() + offset, '\n'));
}

}

std::size_t json_token_end(const std::string& text, std::size_t offset)
{
    std::size_t end = offset + 1;
    if (offset >= text.size()) return text.size();
    if (is_structure(text[offset])) return end;
    if (text[offset] == '"') {
        while (end < text.size() && text[end] != '"') end += text[end] == '\\' ? 2 : 1;
        return std::min(end + 1, text.size());
    }
    while (end < text.size() && !is_space(text[end]) && !is_structure(text[end])) ++end;
    return end;
}

std::string json_location(const JsonTree& tree, std::size_t offset)
{
    const std::string& text = tree.text;
    offset = std::min(offset, text.size());
    for (auto it = tree.additions.rbegin(); it != tree.additions.rend(); ++it)
        if (offset + 1 >= it->begin) return it->option;  // its key stands just before
    const std::size_t line_break = text.rfind('\n', offset == 0 ? std::string::npos : offset - 1);
    const std::size_t begin = offset == 0 || line_break == std::string::npos ? 0 : line_break + 1;
    const auto column =
        1 + std::count_if(text.begin() + begin, text.begin() + offset, [](char c) {
            return (static_cast<unsigned char>(c) & 0xC0) != 0x80;  // not the middle of a character
        });
    return tree.name + ":" + std::to_string(line_of(text, offset)) + ":" + std::to_string(column);
}

std::string json_pointer(const std::string& parent, std::string_view key)
{
    std::string result = parent + "/";
    for (char c : key) {
        if (c == '~')
            result += "~0";
        else if (c == '/')
            result += "~1";
        else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F)
            result += '?';  // messages go to terminals
        else
            result += c;
    }
    return result;
}

namespace {

/// Receives the events of nlohmann's parser, builds the tree and walks along the text itself, since
/// the parser tells what it has read but not where it began.
class TreeBuilder : public nlohmann::json_sax<nlohmann::json> {
public:
    explicit TreeBuilder(JsonTree& tree) : tree_(tree), memory_(tree.text.size()) {}

    bool null() override { return add(std::monostate{}); }
    bool boolean(bool value) override { return add(value); }
    bool number_integer(number_integer_t value) override { return add(static_cast<double>(value)); }
    bool number_unsigned(number_unsigned_t value) override
    {
        return add(static_cast<double>(value));
    }
    bool number_float(number_float_t value, const string_t&) override { return add(value); }
    bool string(string_t& value) override
    {
        take_memory(allocation + sizeof value + value.size());
        return add(std::make_unique<std::string>(std::move(value)));
    }
    bool binary(binary_t&) override { return false; }

    bool start_object(std::size_t) override { return open(std::make_unique<JsonValue::Object>()); }
    bool start_array(std::size_t) override { return open(std::make_unique<JsonValue::Array>()); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }

    bool key(string_t& name) override
    {
        const std::size_t offset = next_token();
        Level& level = levels_.back();
        auto& object = *std::get<std::unique_ptr<JsonValue::Object>>(level.value->data);
        take_memory(2 * sizeof(JsonMember) + name.size() + set_entry + name.size());
        level.set_memory += set_entry + name.size();
        if (!level.keys.insert(name).second) {
            const auto first = std::find_if(object.begin(), object.end(),
                                            [&](const auto& m) { return m.key == name; });
            throw error(offset, json_pointer(pointer(true), name),
                        "key stands here twice, first in line " +
                            std::to_string(line_of(tree_.text, first->offset)));
        }
        object.push_back({static_cast<std::uint32_t>(offset), std::move(name), {}});
        return true;
    }

    bool parse_error(std::size_t position, const std::string&,
                     const nlohmann::detail::exception& exception) override
    {
        const std::string full = exception.what();
        const std::size_t offset = failing_offset(position, full);
        throw error(offset, pointer(), "not valid JSON: " + explanation(full, offset));
    }

private:
    static constexpr std::size_t allocation = 16;  // what one costs beyond its bytes
    static constexpr std::size_t set_entry = 80;

    struct Level {
        JsonValue* value;
        std::set<std::string> keys;  // of an object
        std::size_t set_memory = 0;  // of these
    };

    Error error(std::size_t offset, const std::string& pointer, const std::string& problem) const
    {
        const std::string where = json_location(tree_, offset);
        return Error(ErrorKind::input, pointer.empty() ? where : where + ": " + pointer, problem);
    }

    /// Begin of the next token that is a value, a key or a bracket; the cursor moves to its end.
    std::size_t next_token()
    {
        const std::string& text = tree_.text;
        while (cursor_ < text.size() &&
               (is_space(text[cursor_]) || text[cursor_] == ',' || text[cursor_] == ':'))
            ++cursor_;
        const std::size_t begin = cursor_;
        cursor_ = json_token_end(text, begin);
        return begin;
    }

    /// Counts what the tree needs. A list that grows is held up to twice.
    void take_memory(std::size_t bytes)
    {
        memory_ += bytes;
        if (memory_ > largest_json_tree)
            throw error(cursor_, pointer(),
                        "too many values: they must not need more than " +
                            std::to_string(largest_json_tree >> 20) + " MiB of memory");
    }

    template <class List>
    void give_back_growth(List& list)
    {
        list.shrink_to_fit();
        memory_ -= list.size() * sizeof(typename List::value_type);
    }

    template <class Data>
    JsonValue* place(Data&& data)
    {
        const std::size_t offset = next_token();
        take_memory(2 * sizeof(JsonValue));
        JsonValue value{static_cast<std::uint32_t>(offset), std::forward<Data>(data)};
        JsonValue* target = &tree_.root;
        if (!levels_.empty()) {
            auto& parent = levels_.back().value->data;
            if (auto* array = std::get_if<std::unique_ptr<JsonValue::Array>>(&parent))
                target = &(*array)->emplace_back();
            else
                target = &std::get<std::unique_ptr<JsonValue::Object>>(parent)->back().value;
        }
        *target = std::move(value);
        return target;
    }

    template <class Data>
    bool add(Data&& data)
    {
        place(std::forward<Data>(data));
        return true;
    }

    template <class Data>
    bool open(Data&& data)
    {
        take_memory(2 * allocation + sizeof(JsonValue::Array));
        JsonValue* value = place(std::forward<Data>(data));
        levels_.push_back({value, {}, 0});
        if (levels_.size() > deepest_json)
            throw error(value->offset, "", "nested deeper than " + std::to_string(deepest_json));
        return true;
    }

    bool close()
    {
        next_token();
        auto& data = levels_.back().value->data;
        if (auto* array = std::get_if<std::unique_ptr<JsonValue::Array>>(&data))
            give_back_growth(**array);
        else
            give_back_growth(*std::get<std::unique_ptr<JsonValue::Object>>(data));
        memory_ -= levels_.back().set_memory;
        levels_.pop_back();
        return true;
    }

    /// Pointer to the value that is being read; without its last key for `parent_only`.
    std::string pointer(bool parent_only = false) const
    {
        std::string result;
        for (const Level& level : levels_) {
            if (parent_only && &level == &levels_.back()) break;
            if (auto* array = std::get_if<std::unique_ptr<JsonValue::Array>>(&level.value->data)) {
                const std::size_t done = (*array)->size();
                const bool last = &level == &levels_.back();
                result = json_pointer(result, std::to_string(last || done == 0 ? done : done - 1));
            } else {
                const auto& object =
                    *std::get<std::unique_ptr<JsonValue::Object>>(level.value->data);
                if (!object.empty()) result = json_pointer(result, object.back().key);
            }
        }
        return result;
    }

    /// Begin of the token the parser stumbled over; `position` bytes had been read by then.
    std::size_t failing_offset(std::size_t position, const std::string& message) const
    {
        const std::string& text = tree_.text;
        const std::size_t last_read = std::min(position == 0 ? 0 : position - 1, text.size());
        for (const char* inside : {"UTF-8", "control character", "forbidden character"})
            if (message.find(inside) != std::string::npos) return last_read;
        std::size_t begin = cursor_;
        for (std::size_t i = cursor_; i < text.size() && i <= last_read;) {
            if (is_space(text[i])) {
                ++i;
                continue;
            }
            begin = i;
            i = json_token_end(text, i);
        }
        if (last_read >= text.size()) begin = text.size();
        return begin;
    }

    std::string explanation(const std::string& message, std::size_t offset) const
    {
        const std::string& text = tree_.text;
        const std::string token = text.substr(offset, json_token_end(text, offset) - offset);
        std::size_t before = offset;
        while (before > 0 && is_space(text[before - 1])) --before;
        const char previous = before > 0 ? text[before - 1] : ' ';
        const std::size_t number_end = token.find_first_not_of("+-.0123456789eE");

        if (offset >= text.size()) return "the text ends too early";
        if (message.find("number overflow") != std::string::npos)
            return "the number " + token.substr(0, std::min<std::size_t>(40, number_end)) +
                   " is too large";
        if ((token == "}" || token == "]") && previous == ',')
            return "a comma must not stand before " + token;
        if (token[0] == '/' || token[0] == '#') return "comments are not allowed";
        if (token[0] == '\'') return "texts stand in double quotes";
        for (const char* word :
             {"NaN", "nan", "NAN", "Infinity", "-Infinity", "inf", "-inf", "Inf"})
            if (token == word) return std::string(word) + " is not a JSON number";
        if (message.find("invalid literal") != std::string::npos)
            return "unexpected " + in_quotes(readable(token, 80), 40);
        const std::size_t dash = message.find(" - ");
        std::string rest = dash == std::string::npos ? message : message.substr(dash + 3);
        return rest.substr(0, rest.find("; last read"));  // may hold bytes that are not text
    }

    JsonTree& tree_;
    std::vector<Level> levels_;
    std::size_t cursor_ = 0;
    std::size_t memory_;
};

/// Begin of a token that is too long, with the white space before it. The parser copies it more
/// than once before it can be refused.
std::optional<std::size_t> too_long_token(const std::string& text)
{
    for (std::size_t begin = 0; begin < text.size();) {
        std::size_t end = begin;
        while (end < text.size() && is_space(text[end])) ++end;
        if (end - begin > longest_json_token) return begin;
        const std::size_t token = end;
        end = json_token_end(text, token);
        if (end - token > longest_json_token) return token;
        begin = end;
    }
    return std::nullopt;
}

}

void parse_json(JsonTree& tree)
{
    const auto refuse = [&](std::size_t offset, const std::string& problem) {
        throw Error(ErrorKind::input, json_location(tree, offset), problem);
    };
    if (tree.text.size() > largest_json_file)
        refuse(0, "must not be larger than " + std::to_string(largest_json_file) + " bytes");
    if (tree.text.starts_with("\xEF\xBB\xBF"))
        refuse(0, "begins with a byte-order mark; save as UTF-8 without one");
    if (tree.text.starts_with("\xFF\xFE") || tree.text.starts_with("\xFE\xFF"))
        refuse(0, "is UTF-16; save as UTF-8");
    // nlohmann takes a NUL byte for the end of the text
    if (const std::size_t nul = tree.text.find('\0'); nul != std::string::npos)
        refuse(nul, "contains a NUL byte");
    if (tree.text.find_first_not_of(" \t\r\n") == std::string::npos) refuse(0, "is empty");

    if (const auto offset = too_long_token(tree.text))
        refuse(*offset,
               "must not have more than 1 MiB in one text, number or word, or between two");

    TreeBuilder builder(tree);
    nlohmann::json::sax_parse(tree.text, &builder, nlohmann::json::input_format_t::json,
                              /*strict=*/true, /*ignore_comments=*/false);
}

}
