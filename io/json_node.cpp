#include "io/json_document.h"

#include "io/json_parse.h"
#include "io/problems.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow::io {

namespace {

const JsonMember* member_of(const JsonValue& value, std::string_view key)
{
    const JsonValue::Object* object = object_of(value);
    if (!object) return nullptr;
    const auto it = std::find_if(object->begin(), object->end(),
                                 [&](const JsonMember& m) { return m.key == key; });
    return it == object->end() ? nullptr : &*it;
}

}

bool Range::contains(double value) const
{
    return std::isfinite(value) && (low_open ? value > low : value >= low) &&
           (high_open ? value < high : value <= high);
}

std::string Length::text() const
{
    if (minimum == maximum) return std::to_string(minimum);
    if (maximum == Length{}.maximum) return "at least " + std::to_string(minimum);
    return std::to_string(minimum) + " to " + std::to_string(maximum);
}

std::string Range::text() const
{
    std::string result;
    if (std::isfinite(low)) result = (low_open ? "> " : ">= ") + number_text(low);
    if (std::isfinite(high))
        result += (result.empty() ? "" : " and ") + std::string(high_open ? "< " : "<= ") +
                  number_text(high);
    return result.empty() ? "finite" : result;
}

// ---------------------------------------------------------------------------------- errors

Error JsonNode::error(const std::string& problem) const
{
    const std::string where = json_location(*tree_, value_->offset);
    return Error(ErrorKind::input, pointer_.empty() ? where : where + ": " + pointer_, problem);
}

Error JsonNode::error_at_key(std::string_view key, const std::string& problem) const
{
    const JsonMember* member = member_of(*value_, key);
    const std::string where = json_location(*tree_, member ? member->offset : value_->offset);
    return Error(ErrorKind::input, where + ": " + json_pointer(pointer_, key), problem);
}

Error JsonNode::wrong(const std::string& requirement) const
{
    return error(requirement + ", got " + shown());
}

std::string JsonNode::shown() const
{
    if (is_object()) return "an object";
    if (const auto* array = array_of(*value_))
        return "an array of " + std::to_string(array->size()) + " elements";
    if (const auto* text = text_of(*value_)) return in_quotes(*text);
    const std::size_t end = json_token_end(tree_->text, value_->offset);
    return tree_->text.substr(value_->offset, std::min<std::size_t>(end - value_->offset, 40));
}

// --------------------------------------------------------------------------------- objects

bool JsonNode::is_object() const
{
    return object_of(*value_);
}
bool JsonNode::is_array() const
{
    return array_of(*value_);
}
bool JsonNode::is_text() const
{
    return text_of(*value_);
}
bool JsonNode::is_number() const
{
    return std::holds_alternative<double>(value_->data);
}

bool JsonNode::has(std::string_view key) const
{
    return member_of(*value_, key);
}

std::optional<JsonNode> JsonNode::find(std::string_view key) const
{
    if (!is_object()) throw wrong("must be an object");
    const JsonMember* member = member_of(*value_, key);
    if (!member) return std::nullopt;
    return JsonNode(tree_, &member->value, json_pointer(pointer_, key));
}

JsonNode JsonNode::member(std::string_view key) const
{
    if (auto node = find(key)) return *node;
    throw error("misses the required key " + in_quotes(key));
}

std::vector<std::string> JsonNode::keys() const
{
    const JsonValue::Object* object = object_of(*value_);
    if (!object) throw wrong("must be an object");
    std::vector<std::string> result;
    for (const JsonMember& member : *object) result.push_back(member.key);
    return result;
}

void JsonNode::refuse_other_keys(std::span<const std::string_view> known) const
{
    const JsonValue::Object* object = object_of(*value_);
    if (!object) throw wrong("must be an object");
    Problems problems;
    for (const JsonMember& member : *object) {
        if (std::find(known.begin(), known.end(), member.key) != known.end()) continue;
        const auto nearest = nearest_word(member.key, known);
        problems.collect([&] {
            throw error_at_key(member.key,
                               "unknown key" +
                                   (nearest ? ", did you mean " + in_quotes(*nearest) + "?" : "") +
                                   " (known: " + one_of(known) + ")");
        });
    }
    problems.throw_all();
}

bool JsonNode::misspells(std::string_view key, std::span<const std::string_view> known) const
{
    const JsonValue::Object* object = object_of(*value_);
    if (!object) return false;
    return std::any_of(object->begin(), object->end(), [&](const JsonMember& member) {
        return std::find(known.begin(), known.end(), member.key) == known.end() &&
               nearest_word(member.key, known) == key;
    });
}

void JsonNode::refuse_other_keys(std::initializer_list<std::string_view> known) const
{
    refuse_other_keys(std::span(known.begin(), known.size()));
}

// ---------------------------------------------------------------------------------- arrays

std::size_t JsonNode::size() const
{
    const JsonValue::Array* array = array_of(*value_);
    if (!array) throw wrong("must be an array");
    return array->size();
}

JsonNode JsonNode::element(std::size_t index) const
{
    if (index >= size()) throw error("has only " + std::to_string(size()) + " elements");
    return JsonNode(tree_, &(*array_of(*value_))[index],
                    json_pointer(pointer_, std::to_string(index)));
}

std::vector<JsonNode> JsonNode::elements(Length length) const
{
    if (!is_array()) throw wrong("must be an array");
    const std::size_t n = size();
    if (n < length.minimum || n > length.maximum)
        throw wrong("must have " + length.text() + " elements");
    std::vector<JsonNode> result;
    result.reserve(n);
    for (std::size_t i = 0; i < n; ++i) result.push_back(element(i));
    return result;
}

}
