#include "io/json_schema.h"

#include <cmath>

namespace sigmaflow::io {

using Json = nlohmann::ordered_json;

namespace {

/// Whole limits without ".0", as people write them.
Json limit(double value)
{
    constexpr double largest_exact = 9007199254740992.0;  // 2^53
    if (value == std::floor(value) && std::abs(value) <= largest_exact)
        return static_cast<std::int64_t>(value);
    return value;
}

Json number_schema(const char* type, const Range& range)
{
    Json schema = {{"type", type}};
    if (std::isfinite(range.low))
        schema[range.low_open ? "exclusiveMinimum" : "minimum"] = limit(range.low);
    if (std::isfinite(range.high))
        schema[range.high_open ? "exclusiveMaximum" : "maximum"] = limit(range.high);
    return schema;
}

Json text_schema(const Field& field)
{
    Json schema = {{"type", "string"}};
    if (field.length.maximum != Length{}.maximum) schema["maxLength"] = field.length.maximum;
    if (!field.pattern.empty()) schema["pattern"] = field.pattern;
    return schema;
}

Json list_schema(const Length& length, Json items)
{
    Json schema = {{"type", "array"}, {"items", std::move(items)}};
    if (length.minimum > 0) schema["minItems"] = length.minimum;
    if (length.maximum != Length{}.maximum) schema["maxItems"] = length.maximum;
    return schema;
}

Json bare_schema(const Field& field)
{
    switch (field.kind) {
        case FieldKind::number:
            return number_schema("number", field.range);
        case FieldKind::integer:
            return number_schema("integer", field.range);
        case FieldKind::boolean:
            return {{"type", "boolean"}};
        case FieldKind::text:
            return text_schema(field);
        case FieldKind::word:
            return {{"enum", field.words}};
        case FieldKind::vector:
            return list_schema(Length::exactly(3), number_schema("number", field.range));
        case FieldKind::numbers:
            return list_schema(field.elements, number_schema("number", field.range));
        case FieldKind::texts:
            return list_schema(field.elements, text_schema(field));
        case FieldKind::objects:
            return list_schema(field.elements, {{"type", "object"}});
        case FieldKind::group:
        case FieldKind::sweep:
            break;
    }
    return schema_of(field.members);
}

std::string description(const Field& field)
{
    const bool has_unit = !field.unit.empty() && field.unit != "-";
    return (has_unit ? "[" + field.unit + "] " : "") + field.help;
}

/// One parameter of the members, with a list of values.
Json sweep_schema(const Field& field)
{
    Json properties = Json::object();
    for (const Field& member : field.members)
        properties[member.name] = list_schema({1, 1000}, bare_schema(member));
    return {{"type", "object"},
            {"properties", std::move(properties)},
            {"additionalProperties", false},
            {"minProperties", 1},
            {"maxProperties", 1}};
}

}

Json schema_of(const Field& field)
{
    Json schema = field.kind == FieldKind::sweep ? sweep_schema(field) : bare_schema(field);
    schema["description"] = description(field);
    const bool has_default = !field.required && field.kind != FieldKind::group;
    if (const Json value = has_default ? field.write() : Json(); !value.is_null())
        schema["default"] = value;
    return schema;
}

Json schema_of(const std::vector<Field>& fields)
{
    Json properties = Json::object(), required = Json::array();
    for (const Field& field : fields) {
        properties[field.name] = schema_of(field);
        if (field.required) required.push_back(field.name);
    }
    Json schema = {
        {"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
    if (!required.empty()) schema["required"] = std::move(required);
    return schema;
}

}
