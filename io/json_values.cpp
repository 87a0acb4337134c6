#include "io/json_document.h"
#include "io/json_parse.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace sigmaflow::io {

namespace {

std::string in_brackets(std::string_view unit)
{
    return unit.empty() || unit == "-" ? "" : " [" + std::string(unit) + "]";
}

constexpr std::size_t not_in_array = std::numeric_limits<std::size_t>::max();

}

double JsonNode::checked_number(const JsonValue& value, Range range, std::string_view unit,
                                std::size_t index) const
{
    const double* number = std::get_if<double>(&value.data);
    if (number && range.contains(*number)) return *number;
    const JsonNode node(
        tree_, &value,
        index == not_in_array ? pointer_ : json_pointer(pointer_, std::to_string(index)));
    const bool limited = std::isfinite(range.low) || std::isfinite(range.high);
    throw node.wrong((number    ? "must be " + range.text()
                      : limited ? "must be a number " + range.text()
                                : std::string("must be a number")) +
                     in_brackets(unit));
}

double JsonNode::number(Range range, std::string_view unit) const
{
    return checked_number(*value_, range, unit, not_in_array);
}

std::int64_t JsonNode::integer(std::int64_t low, std::int64_t high) const
{
    const std::string requirement =
        "must be an integer >= " + std::to_string(low) +
        (high == std::numeric_limits<std::int64_t>::max() ? std::string()
                                                          : " and <= " + std::to_string(high));
    if (!is_number()) throw wrong(requirement);
    const std::size_t end = json_token_end(tree_->text, value_->offset);
    const char* first = tree_->text.data() + value_->offset;
    const char* last = tree_->text.data() + end;
    std::int64_t result = 0;
    const auto parsed = std::from_chars(first, last, result);
    if (parsed.ec != std::errc() || parsed.ptr != last) {
        const double value = std::get<double>(value_->data);
        constexpr double largest_exact = 9007199254740992.0;  // 2^53
        if (parsed.ec != std::errc() || value != std::floor(value) ||
            std::abs(value) > largest_exact)
            throw wrong(requirement);
        result = static_cast<std::int64_t>(value);
    }
    if (result < low || result > high) throw wrong(requirement);
    return result;
}

std::uint64_t JsonNode::unsigned_integer() const
{
    if (is_number()) {
        const std::size_t end = json_token_end(tree_->text, value_->offset);
        const char* last = tree_->text.data() + end;
        std::uint64_t result = 0;
        const auto parsed = std::from_chars(tree_->text.data() + value_->offset, last, result);
        if (parsed.ec == std::errc() && parsed.ptr == last) return result;
        const double value = std::get<double>(value_->data);
        constexpr double largest_exact = 9007199254740992.0;  // 2^53
        if (parsed.ec != std::errc::result_out_of_range && value == std::floor(value) &&
            value >= 0 && value <= largest_exact)
            return static_cast<std::uint64_t>(value);
    }
    throw wrong("must be an integer >= 0 and < 2^64");
}

bool JsonNode::boolean() const
{
    const bool* value = std::get_if<bool>(&value_->data);
    if (!value) throw wrong("must be true or false");
    return *value;
}

std::string JsonNode::text(std::size_t longest) const
{
    const std::string* value = text_of(*value_);
    if (!value) throw wrong("must be a text in double quotes");
    if (value->size() > longest)
        throw error("must not be longer than " + std::to_string(longest) + " bytes, got " +
                    std::to_string(value->size()));
    return *value;
}

std::size_t JsonNode::word(std::span<const std::string_view> allowed) const
{
    const std::string* value = text_of(*value_);
    if (!value) throw wrong("must be one of " + one_of(allowed));
    const auto it = std::find(allowed.begin(), allowed.end(), *value);
    if (it != allowed.end()) return static_cast<std::size_t>(it - allowed.begin());
    const auto nearest = nearest_word(*value, allowed);
    throw error("must be one of " + one_of(allowed) + ", got " + in_quotes(*value) +
                (nearest ? ", did you mean " + in_quotes(*nearest) + "?" : ""));
}

std::size_t JsonNode::word(std::initializer_list<std::string_view> allowed) const
{
    return word(std::span(allowed.begin(), allowed.size()));
}

std::vector<double> JsonNode::numbers(Length length, Range range, std::string_view unit) const
{
    const JsonValue::Array* array = array_of(*value_);
    const bool limited = length.minimum > 0 || length.maximum != Length{}.maximum;
    if (!array || array->size() < length.minimum || array->size() > length.maximum)
        throw wrong("must be an array of " + (limited ? length.text() + " " : "") + "numbers");
    std::vector<double> result;
    result.reserve(array->size());
    for (std::size_t i = 0; i < array->size(); ++i)
        result.push_back(checked_number((*array)[i], range, unit, i));
    return result;
}

Vec3 JsonNode::vector(Range range, std::string_view unit) const
{
    const std::vector<double> v = numbers(Length::exactly(3), range, unit);
    return {v[0], v[1], v[2]};
}

Mat3 JsonNode::matrix() const
{
    if (!is_array() || size() != 3) throw wrong("must be an array of 3 rows of 3 numbers");
    Mat3 result;
    for (int row = 0; row < 3; ++row)
        result.row(row) = element(static_cast<std::size_t>(row)).vector();
    return result;
}

std::vector<Vec3> JsonNode::vectors(Length length, Range range, std::string_view unit) const
{
    std::vector<Vec3> result;
    for (const JsonNode& node : elements(length)) result.push_back(node.vector(range, unit));
    return result;
}

}
