#include "workflows/sweep.h"

#include "engine/random.h"
#include "io/checksum.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>

namespace sigmaflow::workflows {

using Json = nlohmann::ordered_json;

namespace {

constexpr std::size_t longest_word = 40;       // of a value in a name
constexpr std::uint32_t repeat_stream = 0x73;  // of the seeds of repeats

Error wrong_usage(const std::string& option, const std::string& text, const std::string& problem)
{
    return Error(ErrorKind::usage, option, problem + ", got " + io::in_quotes(text));
}

bool is_utf8(const std::string& text)
{
    try {
        static_cast<void>(Json(text).dump());
        return true;
    } catch (const Json::type_error&) {
        return false;
    }
}

Json json_value(const std::string& text)
{
    const Json value = Json::parse(text, nullptr, false);
    return value.is_discarded() ? Json(text) : value;
}

/// At each mark that is not inside of brackets or quotes.
std::vector<std::string> split(const std::string& text, char mark)
{
    std::vector<std::string> parts(1);
    int depth = 0;
    bool quoted = false, escaped = false;
    for (const char c : text) {
        if (c == mark && depth == 0 && !quoted) {
            parts.emplace_back();
            continue;
        }
        if (quoted && c == '"' && !escaped)
            quoted = false;
        else if (!quoted && c == '"')
            quoted = true;
        escaped = quoted && c == '\\' && !escaped;
        if (!quoted && (c == '[' || c == '{')) ++depth;
        if (!quoted && (c == ']' || c == '}')) --depth;
        parts.back() += c;
    }
    return parts;
}

std::optional<double> number(const std::string& text)
{
    double value = 0;
    const char* end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, value);
    if (read.ec != std::errc() || read.ptr != end || !std::isfinite(value)) return std::nullopt;
    return value;
}

/// As it is meant: the third of 0.54:0.58:5 is 0.56, not 0.5600000000000001.
Json rounded(double value)
{
    char text[40];
    std::snprintf(text, sizeof text, "%.12g", value);
    return Json::parse(text);
}

/// Nothing if the text is no range.
std::optional<std::vector<Json>> range(const std::string& option, const std::string& text)
{
    const std::vector<std::string> parts = split(text, ':');
    const bool ratios = parts.size() == 4 && parts[3] == "log";
    if (parts.size() != 3 && !ratios) return std::nullopt;
    const auto from = number(parts[0]), to = number(parts[1]), count = number(parts[2]);
    if (!from || !to || !count) return std::nullopt;
    if (*count != std::floor(*count) || *count < 2 || *count > static_cast<double>(most_points))
        throw wrong_usage(
            option, text,
            "must have 2 to " + std::to_string(most_points) + " values in from:to:count");
    if (ratios && !(*from > 0 && *to > 0))
        throw wrong_usage(option, text, "must have ends > 0 for equal ratios");
    std::vector<Json> values;
    for (int k = 0; k < *count; ++k) {
        const double share = k / (*count - 1);
        values.push_back(
            rounded(ratios ? *from * std::pow(*to / *from, share) : *from + share * (*to - *from)));
    }
    return values;
}

std::string last_part(const std::string& pointer)
{
    return pointer.substr(pointer.rfind('/') + 1);
}

bool is_plain(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.' || c == '+';
}

/// Fit for the name of a file; false: something was lost.
bool append_plain(std::string& name, std::string word)
{
    bool whole = word.size() <= longest_word;
    if (!whole) word.resize(longest_word);
    for (char& c : word)
        if (!is_plain(c)) {
            c = '-';
            whole = false;
        }
    name += word;
    return whole;
}

/// In the order of the labels: it does not matter how the options are ordered.
std::string point_name(const std::vector<std::string>& names, const std::vector<Json>& values)
{
    std::vector<std::pair<std::string, const Json*>> parts;
    for (std::size_t k = 0; k < names.size(); ++k) parts.emplace_back(names[k], &values[k]);
    std::sort(parts.begin(), parts.end());
    std::string name, all;
    bool whole = true;
    for (const auto& [label, value] : parts) {
        if (!name.empty()) name += '_';
        std::string word = value_text(*value);
        all += label + "=" + word + "\n";
        if (const auto slash = word.rfind('/'); slash != std::string::npos && value->is_string()) {
            word.erase(0, slash + 1);  // files are known by their last name
            whole = false;
        }
        whole = append_plain(name, label + "_" + word) && whole;
    }
    if (!whole) name += "_" + io::hexadecimal(io::checksum(all)).substr(0, 8);
    return name.empty() ? "point" : name;
}

std::vector<Point> combinations(const Sweep& sweep)
{
    std::vector<std::vector<Json>> all(1);
    for (const Swept& swept : sweep.swept) {
        if (all.size() * swept.values.size() > most_points)
            throw Error(ErrorKind::usage, "--sweep",
                        "stands for more than " + std::to_string(most_points) + " points");
        std::vector<std::vector<Json>> longer;
        for (const auto& values : all)
            for (const Json& value : swept.values) {
                longer.push_back(values);
                longer.back().push_back(value);
            }
        all = std::move(longer);
    }
    const std::vector<std::string> names = labels(sweep.swept);
    std::vector<Point> points;
    for (const auto& values : all) {
        Point point{point_name(names, values), values, 1, sweep.settings};
        for (std::size_t k = 0; k < values.size(); ++k)
            point.overrides.push_back({"--sweep", sweep.swept[k].pointer, values[k].dump()});
        points.push_back(std::move(point));
    }
    return points;
}

/// JSON holds no other paths.
std::string absolute_path(const std::filesystem::path& file)
{
    std::string path = std::filesystem::absolute(file).lexically_normal().string();
    if (!is_utf8(path)) throw Error(ErrorKind::input, path, "is no path in UTF-8");
    return path;
}

}

Swept parse_swept(const std::string& text)
{
    const io::Override parts = io::parse_override("--sweep", text);
    if (!is_utf8(text)) throw Error(ErrorKind::usage, "--sweep", "must be UTF-8");
    Swept swept{parts.pointer, {}};
    const std::string option = "--sweep " + parts.pointer;
    if (auto values = range(option, parts.value)) {
        swept.values = std::move(*values);
    } else {
        for (const std::string& value : split(parts.value, ',')) {
            if (value.empty()) throw wrong_usage(option, parts.value, "must not have empty values");
            swept.values.push_back(json_value(value));
        }
    }
    std::set<std::string> seen;
    for (const Json& value : swept.values)
        if (!seen.insert(value_text(value)).second)
            throw Error(ErrorKind::usage, option, "has the value " + value_text(value) + " twice");
    return swept;
}

std::vector<std::string> labels(const std::vector<Swept>& swept)
{
    std::vector<std::string> result;
    for (const Swept& one : swept) {
        const auto same = std::count_if(swept.begin(), swept.end(), [&](const Swept& other) {
            return last_part(other.pointer) == last_part(one.pointer);
        });
        std::string label = same > 1 ? one.pointer.substr(1) : last_part(one.pointer);
        for (char& c : label)
            if (!is_plain(c) || c == '.') c = '_';
        result.push_back(label);
    }
    return result;
}

std::string value_text(const Json& value)
{
    if (value.is_string()) return value.get<std::string>();
    return value.is_number_float() ? io::number_text(value.get<double>()) : value.dump();
}

std::vector<Point> points_of(const Sweep& sweep,
                             const std::function<std::uint64_t(const Point&)>& seed_of)
{
    std::vector<Point> points;
    for (Point& point : combinations(sweep)) {
        const std::uint64_t seed = sweep.repeats > 1 ? seed_of(point) : 0;
        points.push_back(std::move(point));
        const Point first = points.back();
        for (int repeat = 2; repeat <= sweep.repeats; ++repeat) {
            points.push_back(first);
            points.back().repeat = repeat;
            points.back().name += "_repeat_" + std::to_string(repeat);
            points.back().overrides.push_back(
                {"--repeat", "/suspension/seed",
                 std::to_string(
                     derived_seed(seed, repeat_stream, static_cast<std::uint64_t>(repeat)))});
        }
        if (points.size() > most_points)
            throw Error(ErrorKind::usage, "--repeat",
                        "leads to more than " + std::to_string(most_points) + " points");
    }
    return points;
}

void freeze_paths(Json& value, const std::filesystem::path& folder)
{
    if (value.is_structured()) {
        for (auto& inner : value) freeze_paths(inner, folder);
    } else if (value.is_string()) {
        const std::string text = value.get<std::string>();
        std::error_code error;
        // words of the workflow have neither; longer texts are no paths
        const bool may_be_path =
            text.find_first_of("./") != std::string::npos && text.size() < 4096;
        if (may_be_path && std::filesystem::is_regular_file(folder / text, error))
            value = absolute_path(folder / text);
    }
}

void freeze_paths(io::Override& setting, const std::filesystem::path& folder)
{
    const Json given = json_value(setting.value);
    Json frozen = given;
    freeze_paths(frozen, folder);
    if (frozen != given) setting.value = frozen.dump();
}

Json frozen_workflow(const std::filesystem::path& file)
{
    const Json workflow = Json::parse(io::JsonDocument::read(file).text());
    if (!workflow.is_object()) return workflow;
    Json frozen = {{"name", file.stem().string()}};
    for (const auto& [key, value] : workflow.items()) {
        frozen[key] = value;
        if (key == "suspension" || key == "steps") freeze_paths(frozen[key], file.parent_path());
    }
    return frozen;
}

}
