#include "io/series_csv.h"

#include "io/json_document.h"

#include <algorithm>
#include <charconv>
#include <string>

namespace sigmaflow::io {
namespace {

/// One row of text: text(field) of every field, separated by commas.
template <class Text>
std::string row(const Text& text)
{
    std::string line;
    for (const SampleField& field : sample_fields()) {
        if (!line.empty()) line += ',';
        line += text(field);
    }
    return line;
}

std::string header()
{
    return row([](const SampleField& field) { return std::string(field.name); });
}

/// Cuts the first line, without its end, off the text.
std::string_view cut_line(std::string_view& text)
{
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    return line;
}

Sample parse_row(std::string_view line, const std::string& where)
{
    Sample sample;
    const char* place = line.data();
    const char* const end = line.data() + line.size();
    bool first = true;
    for (const SampleField& field : sample_fields()) {
        if (!first && (place == end || *place++ != ','))
            throw Error(ErrorKind::input, where,
                        "must have a number for " + std::string(field.name));
        const auto [rest, failure] = std::from_chars(place, end, sample.*field.value);
        if (failure != std::errc())
            throw Error(ErrorKind::input, where,
                        "must have a number for " + std::string(field.name) + ", got \"" +
                            std::string(place, std::find(place, end, ',')) + '"');
        place = rest;
        first = false;
    }
    if (place != end) throw Error(ErrorKind::input, where, "has more columns than " + header());
    return sample;
}

}

SeriesWriter::SeriesWriter(const std::filesystem::path& path) : file_(path)
{
    const std::string units = row([](const SampleField& field) {
        return std::string(field.name) + " [" + std::string(field.unit) + ']';
    });
    file_.write("# " + units + '\n' + header() + '\n');
}

void SeriesWriter::append(const Sample& sample)
{
    const auto text = [&sample](const SampleField& field) {
        return number_text(sample.*field.value);
    };
    file_.write(row(text) + '\n');
}

std::vector<Sample> read_series(const std::filesystem::path& path)
{
    const std::string content = read_file(path);
    std::string_view rest = content;
    std::vector<Sample> series;
    bool named = false;
    for (int number = 1; !rest.empty(); ++number) {
        const std::string_view line = cut_line(rest);
        const std::string where = path.string() + ':' + std::to_string(number);
        if (line.starts_with('#')) continue;
        if (named) {
            series.push_back(parse_row(line, where));
        } else {
            if (line != header())
                throw Error(ErrorKind::input, where, "the columns must be " + header());
            named = true;
        }
    }
    if (!named)
        throw Error(ErrorKind::input, path.string(), "has no line with the names of the columns");
    return series;
}

}
