#include "io/number_file.h"

#include "io/atomic_file.h"

#include <algorithm>
#include <charconv>
#include <optional>

namespace sigmaflow::io {

namespace {

constexpr std::string_view blank = " \t\r\v\f";

std::string_view trimmed(std::string_view text)
{
    const std::size_t first = text.find_first_not_of(blank);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

std::optional<double> number_of(std::string_view text)
{
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

}

std::vector<double> read_numbers(const std::filesystem::path& path, Length length, Range range,
                                 std::string_view unit)
{
    const std::string text = read_file(path);
    const std::string allowed = range.text() + " [" + std::string(unit) + "]";
    std::vector<double> numbers;
    std::size_t line_number = 0;
    for (std::size_t from = 0; from < text.size(); ++line_number) {
        const std::size_t end = std::min(text.find('\n', from), text.size());
        const std::string_view line(text.data() + from, end - from);
        from = end + 1;
        const std::string_view content = trimmed(line.substr(0, line.find('#')));
        if (content.empty()) continue;
        const std::string where = path.string() + ":" + std::to_string(line_number + 1);
        const auto value = number_of(content);
        if (!value || !range.contains(*value))
            throw Error(ErrorKind::input, where,
                        "must be one number a line, " + allowed + ", got " + in_quotes(content));
        if (numbers.size() == length.maximum)
            throw Error(ErrorKind::input, where,
                        "must have " + length.text() + " numbers, here is one more");
        numbers.push_back(*value);
    }
    if (numbers.size() < length.minimum)
        throw Error(
            ErrorKind::input, path.string(),
            "must have " + length.text() + " numbers, got " + std::to_string(numbers.size()));
    return numbers;
}

}
