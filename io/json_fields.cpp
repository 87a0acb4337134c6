#include "io/json_fields.h"

#include "io/problems.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace sigmaflow::io {

using nlohmann::ordered_json;

namespace {

Range unsigned_range()
{
    return from_below(0, 18446744073709551616.0);  // 2^64
}

}

std::string Field::allowed() const
{
    std::string result;
    switch (kind) {
        case FieldKind::word:
            for (std::string_view word : words)
                result += (result.empty() ? "" : ", ") + std::string(word);
            return result;
        case FieldKind::boolean:
            return "true, false";
        case FieldKind::text:
            return "text";
        case FieldKind::group:
            return "object";
        case FieldKind::vector:
            return "3 numbers " + range.text();
        case FieldKind::numbers:
            return "numbers " + range.text();
        case FieldKind::texts:
            return "list of texts";
        case FieldKind::objects:
            return "list of objects";
        case FieldKind::sweep:
            return "object with one parameter and its values";
        case FieldKind::integer:
            return "integer " + range.text();
        case FieldKind::number:
            break;
    }
    return range.text();
}

std::string Field::default_text() const
{
    if (required) return "required";
    const ordered_json value = write();
    return value.is_null() ? "none" : value.dump();
}

Field& Fields::add(Field field)
{
    return fields_.emplace_back(std::move(field));
}

Field& Fields::operator()(std::string name, double& value, Range range, std::string unit,
                          std::string help)
{
    Field field{std::move(name), unit, std::move(help), FieldKind::number, range};
    field.read = [&value, range, unit](const JsonNode& node) { value = node.number(range, unit); };
    field.write = [&value] { return ordered_json(value); };
    return add(std::move(field));
}

Field& Fields::operator()(std::string name, std::optional<double>& value, Range range,
                          std::string unit, std::string help)
{
    Field field{std::move(name), unit, std::move(help), FieldKind::number, range};
    field.read = [&value, range, unit](const JsonNode& node) { value = node.number(range, unit); };
    field.write = [&value] { return value ? ordered_json(*value) : ordered_json(nullptr); };
    return add(std::move(field));
}

Field& Fields::operator()(std::string name, int& value, Integers range, std::string unit,
                          std::string help)
{
    const Range shown = between(static_cast<double>(range.low), static_cast<double>(range.high));
    Field field{std::move(name), std::move(unit), std::move(help), FieldKind::integer, shown};
    field.read = [&value, range](const JsonNode& node) {
        value = static_cast<int>(node.integer(range.low, range.high));
    };
    field.write = [&value] { return ordered_json(value); };
    return add(std::move(field));
}

Field& Fields::operator()(std::string name, std::optional<int>& value, Integers range,
                          std::string unit, std::string help)
{
    const Range shown = between(static_cast<double>(range.low), static_cast<double>(range.high));
    Field field{std::move(name), std::move(unit), std::move(help), FieldKind::integer, shown};
    field.read = [&value, range](const JsonNode& node) {
        value = static_cast<int>(node.integer(range.low, range.high));
    };
    field.write = [&value] { return value ? ordered_json(*value) : ordered_json(nullptr); };
    return add(std::move(field));
}

Field& Fields::operator()(std::string name, std::uint64_t& value, std::string help)
{
    Field field{std::move(name), "-", std::move(help), FieldKind::integer, unsigned_range()};
    field.read = [&value](const JsonNode& node) { value = node.unsigned_integer(); };
    field.write = [&value] { return ordered_json(value); };
    return add(std::move(field));
}

Field& Fields::operator()(std::string name, std::optional<std::uint64_t>& value, std::string help)
{
    Field field{std::move(name), "-", std::move(help), FieldKind::integer, unsigned_range()};
    field.read = [&value](const JsonNode& node) { value = node.unsigned_integer(); };
    field.write = [&value] { return value ? ordered_json(*value) : ordered_json(nullptr); };
    return add(std::move(field));
}

Field& Fields::operator()(std::string name, bool& value, std::string help)
{
    Field field{.name = std::move(name), .help = std::move(help), .kind = FieldKind::boolean};
    field.read = [&value](const JsonNode& node) { value = node.boolean(); };
    field.write = [&value] { return ordered_json(value); };
    return add(std::move(field));
}

Field& Fields::operator()(std::string name, std::string& value, std::size_t longest,
                          std::string help)
{
    Field field{.name = std::move(name), .help = std::move(help), .kind = FieldKind::text};
    field.length = {0, longest};
    field.read = [&value, longest](const JsonNode& node) { value = node.text(longest); };
    field.write = [&value] { return value.empty() ? ordered_json(nullptr) : ordered_json(value); };
    return add(std::move(field));
}

Field& Fields::operator()(std::string name, std::string& value, std::vector<std::string_view> words,
                          std::string help)
{
    const auto get = [&value, words] {
        const auto it = std::find(words.begin(), words.end(), value);
        return static_cast<std::size_t>(it == words.end() ? 0 : it - words.begin());
    };
    const auto set = [&value, words](std::size_t index) { value = words[index]; };
    return add_word(std::move(name), words, std::move(help), get, set);
}

Field& Fields::add_word(std::string name, std::vector<std::string_view> words, std::string help,
                        std::function<std::size_t()> get, std::function<void(std::size_t)> set)
{
    Field field{.name = std::move(name), .help = std::move(help), .kind = FieldKind::word};
    field.words = words;
    field.read = [set, words](const JsonNode& node) { set(node.word(words)); };
    field.write = [get, words] { return ordered_json(words[get()]); };
    return add(std::move(field));
}

Field& Fields::operator()(std::string name, Vec3& value, Range range, std::string unit,
                          std::string help)
{
    Field field{std::move(name), unit, std::move(help), FieldKind::vector, range};
    field.read = [&value, range, unit](const JsonNode& node) { value = node.vector(range, unit); };
    field.write = [&value] { return ordered_json{value.x(), value.y(), value.z()}; };
    return add(std::move(field));
}

Field& Fields::operator()(std::string name, std::vector<double>& value, Length length, Range range,
                          std::string unit, std::string help)
{
    Field field{std::move(name), unit, std::move(help), FieldKind::numbers, range};
    field.elements = length;
    field.read = [&value, length, range, unit](const JsonNode& node) {
        value = node.numbers(length, range, unit);
    };
    field.write = [&value] { return value.empty() ? ordered_json(nullptr) : ordered_json(value); };
    return add(std::move(field));
}

Field& Fields::operator()(std::string name, std::vector<std::string>& value, Length length,
                          std::size_t longest, std::string help)
{
    Field field{.name = std::move(name), .help = std::move(help), .kind = FieldKind::texts};
    field.length = {0, longest};
    field.elements = length;
    field.read = [&value, length, longest](const JsonNode& node) {
        value.clear();
        for (const JsonNode& text : node.elements(length)) value.push_back(text.text(longest));
    };
    field.write = [&value] { return value.empty() ? ordered_json(nullptr) : ordered_json(value); };
    return add(std::move(field));
}

Field& Fields::group(std::string name, std::string help,
                     const std::function<void(Fields&)>& describe)
{
    Fields inner;
    describe(inner);
    Field field{.name = std::move(name), .help = std::move(help), .kind = FieldKind::group};
    field.members = std::move(inner.fields_);
    field.read = [members = field.members](const JsonNode& node) { read_fields(node, members); };
    field.write = [members = field.members] { return write_fields(members); };
    return add(std::move(field));
}

Field& Fields::changes(std::string name, std::string help,
                       const std::function<void(Fields&)>& describe, ordered_json& given)
{
    Fields inner;
    describe(inner);
    Field field{.name = std::move(name), .help = std::move(help), .kind = FieldKind::group};
    field.members = inner.fields_;
    for (Field& member : field.members)  // the default is the value that would be replaced
        member.write = [] { return ordered_json(); };
    field.read = [members = std::move(inner.fields_), &given](const JsonNode& node) {
        read_fields(node, members);
        given = ordered_json::object();
        for (const Field& member : members)
            if (node.has(member.name)) given[member.name] = member.write();
    };
    field.write = [&given] { return given; };
    return add(std::move(field));
}

void read_fields(const JsonNode& object, const std::vector<Field>& fields)
{
    if (!object.is_object()) throw object.wrong("must be an object");
    std::vector<std::string_view> names;
    for (const Field& field : fields) names.push_back(field.name);
    Problems problems;
    problems.collect([&] { object.refuse_other_keys(names); });
    for (const Field& field : fields)
        problems.collect([&] {
            if (const auto node = object.find(field.name))
                field.read(*node);
            else if (field.required && !object.misspells(field.name, names))
                object.member(field.name);  // throws
        });
    problems.throw_all();
}

ordered_json write_fields(const std::vector<Field>& fields)
{
    ordered_json result = ordered_json::object();
    for (const Field& field : fields) {
        ordered_json value = field.write();
        if (!value.is_null()) result[field.name] = std::move(value);
    }
    return result;
}

}
