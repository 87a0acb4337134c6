#include "workflows/run_comparison.h"

#include "engine/archive.h"
#include "io/atomic_file.h"
#include "io/guarded.h"
#include "io/json_document.h"
#include "io/run_file.h"
#include "io/series_csv.h"
#include "workflows/past_run.h"
#include "workflows/run_folder.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace sigmaflow::workflows {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

using Series = std::vector<Sample>;

/// 0 if they are the same; otherwise greater than the tolerance only if they differ.
double relative_difference(double a, double b)
{
    if (std::memcmp(&a, &b, sizeof a) == 0) return 0;
    const double scale = std::max(std::abs(a), std::abs(b));
    // +0 and -0 are not the same bits, but no tolerance tells them apart
    return scale > 0 ? std::abs(a - b) / scale : std::numeric_limits<double>::min();
}

Series series_of(const fs::path& file)
{
    if (file.extension() == ".csv") return io::read_series(file);
    if (file.extension() != ".h5")
        throw Error(ErrorKind::input, file.string(),
                    "is neither a folder of a run nor series.csv, run.h5 or summary.json");
    // HDF5 can crash on a damaged file
    const std::string bytes = io::guarded(file, io::limits_for(file), [&] {
        Series series = io::read_run(file).series;
        ArchiveWriter a;
        a(series);
        return a.bytes();
    });
    Series series;
    ArchiveReader a(bytes);
    a(series);
    return series;
}

bool same_strain(double a, double b)
{
    return std::abs(a - b) <= 1e-12 * std::max(1., std::abs(a));
}

/// Pairs of rows at the same strain.
std::vector<std::pair<std::size_t, std::size_t>> common_rows(const Series& a, const Series& b)
{
    std::vector<std::pair<std::size_t, std::size_t>> rows;
    for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
        if (same_strain(a[i].strain, b[j].strain))
            rows.emplace_back(i++, j++);
        else
            a[i].strain < b[j].strain ? ++i : ++j;
    }
    return rows;
}

SeriesComparison compared(const std::string& name, const Series& a, const Series& b,
                          double tolerance)
{
    if (a.empty() || b.empty()) throw Error(ErrorKind::input, name, "has no rows");
    const auto rows = common_rows(a, b);
    if (rows.empty())
        throw Error(ErrorKind::input, name, "the two series have no strain in common");
    SeriesComparison result{.name = name,
                            .rows_a = a.size(),
                            .rows_b = b.size(),
                            .common = rows.size(),
                            .end_a = a.back().strain,
                            .end_b = b.back().strain,
                            .quantities = {}};
    for (const SampleField& field : sample_fields()) {
        QuantityDifference found{.name = std::string(field.name)};
        for (const auto& row : rows) {
            const Sample &one = a[row.first], &other = b[row.second];
            const double difference = relative_difference(one.*field.value, other.*field.value);
            if (difference <= tolerance) continue;
            if (found.rows++ == 0) {
                found.row = row.first;
                found.strain = one.strain;
                found.a = one.*field.value;
                found.b = other.*field.value;
            }
            if (difference <= found.largest) continue;
            found.largest = difference;
            found.largest_strain = one.strain;
        }
        if (found.rows > 0) result.quantities.push_back(std::move(found));
    }
    std::stable_sort(result.quantities.begin(), result.quantities.end(),
                     [](const auto& x, const auto& y) { return x.row < y.row; });
    return result;
}

bool is_container(const Json& value)
{
    return value.is_object() || value.is_array();
}

bool same_value(const Json& a, const Json& b, double tolerance)
{
    if (a.is_number() && b.is_number())
        return relative_difference(a.get<double>(), b.get<double>()) <= tolerance;
    return a == b;
}

std::string escaped(std::string key)
{
    Json::json_pointer pointer;
    pointer.push_back(std::move(key));
    return pointer.to_string();
}

/// All values that differ; those that only one has count.
void compare_values(const Json& a, const Json& b, const std::string& place, double tolerance,
                    std::vector<ValueDifference>& found)
{
    if (!is_container(a) || !is_container(b) || a.is_array() != b.is_array()) {
        if (!same_value(a, b, tolerance)) found.push_back({place, a, b});
        return;
    }
    if (a.is_array()) {
        for (std::size_t k = 0; k < std::max(a.size(), b.size()); ++k)
            compare_values(k < a.size() ? a[k] : Json(), k < b.size() ? b[k] : Json(),
                           place + "/" + std::to_string(k), tolerance, found);
        return;
    }
    const auto left_out = [&](const std::string& key) {
        return tolerance > 0 && place.starts_with("/steps/") && (key == "steps" || key == "solver");
    };
    for (const auto& [key, value] : a.items())
        if (!left_out(key))
            compare_values(value, b.contains(key) ? b[key] : Json(), place + escaped(key),
                           tolerance, found);
    for (const auto& [key, value] : b.items())
        if (!left_out(key) && !a.contains(key)) found.push_back({place + escaped(key), {}, value});
}

Json json_of(const fs::path& file)
{
    return Json::parse(io::JsonDocument::read(file).text());
}

/// Steps by their names, so that another step in between is one difference.
Json by_name(Json workflow)
{
    Json steps = Json::object();
    for (const Json& step : workflow["steps"]) steps[step["name"].get<std::string>()] = step;
    workflow["steps"] = std::move(steps);
    return workflow;
}

void compare_folders(const fs::path& a, const fs::path& b, RunComparison& result)
{
    const PastRun one = read_past_run(a), other = read_past_run(b);
    compare_values(by_name(one.manifest["workflow"]), by_name(other.manifest["workflow"]), "", 0,
                   result.parameters);
    for (const PastStep& step : one.steps) {
        const fs::path name = fs::path(step.name) / series_name;
        std::error_code error;
        if (fs::exists(a / name, error) && fs::exists(b / name, error))
            result.series.push_back(compared(step.name, io::read_series(a / name),
                                             io::read_series(b / name), result.tolerance));
    }
    const auto summary = [](const fs::path& folder) {
        std::error_code error;
        return fs::exists(folder / summary_name, error) ? json_of(folder / summary_name)["steps"]
                                                        : Json::object();
    };
    compare_values(summary(a), summary(b), "/steps", result.tolerance, result.results);
}

}

bool RunComparison::equal() const
{
    return results.empty() &&
           std::all_of(series.begin(), series.end(), [](const auto& s) { return s.equal(); });
}

RunComparison compare_runs(const fs::path& a, const fs::path& b, double tolerance)
{
    RunComparison result;
    result.tolerance = tolerance;
    for (const fs::path& path : {a, b}) {
        std::error_code error;
        if (!fs::exists(path, error))
            throw Error(ErrorKind::missing, path.string(),
                        "cannot be read: no such file or folder");
    }
    if (fs::is_directory(a) != fs::is_directory(b) ||
        (a.extension() == ".json") != (b.extension() == ".json"))
        throw Error(ErrorKind::input, "",
                    a.string() + " and " + b.string() +
                        " are of different kinds: compare two folders, two series (series.csv or "
                        "run.h5) or two summary.json");
    if (fs::is_directory(a))
        compare_folders(a, b, result);
    else if (a.extension() == ".json")
        compare_values(json_of(a), json_of(b), "", tolerance, result.results);
    else
        result.series.push_back(
            compared(a.filename().string(), series_of(a), series_of(b), tolerance));
    return result;
}

}
