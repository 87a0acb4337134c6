// Differences of two runs for people and for programs.
#include "io/json_document.h"
#include "workflows/run_comparison.h"

#include <algorithm>
#include <array>
#include <cstdio>

namespace sigmaflow::workflows {

using Json = nlohmann::ordered_json;

namespace {

constexpr std::size_t most_lines = 30, longest_value = 40;

std::string shown(const Json& value)
{
    if (value.is_null()) return "-";
    std::string text =
        value.is_number_float() ? io::number_text(value.get<double>()) : value.dump();
    return text.size() > longest_value ? text.substr(0, longest_value) + "..." : text;
}

std::string values_text(const std::string& title, const std::vector<ValueDifference>& values)
{
    if (values.empty()) return "";
    std::string text = title + "\n";
    for (std::size_t k = 0; k < std::min(values.size(), most_lines); ++k)
        text +=
            "  " + values[k].place + ": " + shown(values[k].a) + " | " + shown(values[k].b) + "\n";
    if (values.size() > most_lines)
        text += "  and " + std::to_string(values.size() - most_lines) + " more (--json: all)\n";
    return text;
}

std::string series_text(const SeriesComparison& series)
{
    std::string text = series.name + ": " + std::to_string(series.common) + " common rows of " +
                       std::to_string(series.rows_a) + " | " + std::to_string(series.rows_b) +
                       (series.quantities.empty() ? ", equal" : "");
    if (series.end_a != series.end_b)
        text += ", ends at strain " + io::number_text(series.end_a) + " | " +
                io::number_text(series.end_b);
    text += "\n";
    if (series.quantities.empty()) return text;
    std::array<char, 200> line{};
    const auto add = [&](auto... values) {
        std::snprintf(line.data(), line.size(), "  %-28s %12s %6s %24s %24s %12s %12s\n",
                      values...);
        text += line.data();
    };
    add("quantity", "from strain", "row", "value", "value", "largest", "at strain");
    for (const QuantityDifference& q : series.quantities) {
        std::array<char, 16> largest{};
        std::snprintf(largest.data(), largest.size(), "%.2g", q.largest);
        add(q.name.c_str(), io::number_text(q.strain).c_str(), std::to_string(q.row).c_str(),
            io::number_text(q.a).c_str(), io::number_text(q.b).c_str(), largest.data(),
            io::number_text(q.largest_strain).c_str());
    }
    return text;
}

Json values_json(const std::vector<ValueDifference>& values)
{
    Json list = Json::array();
    for (const ValueDifference& value : values)
        list.push_back({{"place", value.place}, {"a", value.a}, {"b", value.b}});
    return list;
}

Json series_json(const SeriesComparison& series)
{
    Json quantities = Json::array();
    for (const QuantityDifference& q : series.quantities)
        quantities.push_back({{"name", q.name},
                              {"strain", q.strain},
                              {"row", q.row},
                              {"rows", q.rows},
                              {"a", q.a},
                              {"b", q.b},
                              {"largest_relative_difference", q.largest},
                              {"largest_at_strain", q.largest_strain}});
    return {{"name", series.name},     {"equal", series.equal()}, {"rows_a", series.rows_a},
            {"rows_b", series.rows_b}, {"common", series.common}, {"end_a", series.end_a},
            {"end_b", series.end_b},   {"quantities", quantities}};
}

}

std::string comparison_text(const RunComparison& comparison)
{
    std::string text = values_text("parameters", comparison.parameters);
    for (const SeriesComparison& series : comparison.series) text += series_text(series);
    text += values_text("results", comparison.results);
    const std::string within = comparison.tolerance > 0 ? " within a relative difference of " +
                                                              io::number_text(comparison.tolerance)
                                                        : " bit by bit";
    return text + (comparison.equal() ? "equal" + within : "different") + "\n";
}

Json comparison_json(const RunComparison& comparison)
{
    Json series = Json::array();
    for (const SeriesComparison& one : comparison.series) series.push_back(series_json(one));
    return {{"event", "compare"},
            {"equal", comparison.equal()},
            {"tolerance", comparison.tolerance},
            {"parameters", values_json(comparison.parameters)},
            {"series", series},
            {"results", values_json(comparison.results)}};
}

}
