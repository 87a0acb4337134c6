#include "workflows/sweep_figure.h"

#include "workflows/pictures.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sigmaflow::workflows {

using Json = nlohmann::ordered_json;
using Row = std::map<std::string, Json>;

namespace {

constexpr std::string_view mean_ending = ".mean";
constexpr double wide = 10;  // largest over smallest value of a logarithmic axis

double number_in(const Row& row, const std::string& column)
{
    const auto it = row.find(column);
    return it != row.end() && it->second.is_number() ? it->second.get<double>()
                                                     : std::numeric_limits<double>::quiet_NaN();
}

std::string error_column(std::string column)
{
    if (column.ends_with(mean_ending)) column.resize(column.size() - mean_ending.size());
    return column + ".standard_error";
}

std::string spaced(std::string text)
{
    std::replace(text.begin(), text.end(), '_', ' ');
    return text;
}

/// "viscosity" of "shear_0.5.viscosity.mean"
std::string quantity_of(std::string column)
{
    if (column.ends_with(mean_ending)) column.resize(column.size() - mean_ending.size());
    return column.substr(column.rfind('.') + 1);
}

std::string axis_title(const std::string& quantity, const std::string& unit)
{
    if (quantity == "volume_fraction") return "volume fraction $ϕ$";
    if (quantity == "stress") return "shear stress $σ$/$σ$_{0}";
    for (const SampleField& field : sample_fields())
        if (field.name == quantity) return axis_text(field);
    return spaced(quantity) + (unit.empty() || unit == "-" ? "" : " [" + unit + "]");
}

/// The first parameter whose values are numbers; else the first one.
std::size_t abscissa(const Sweep& sweep)
{
    for (std::size_t k = 0; k < sweep.swept.size(); ++k)
        if (std::all_of(sweep.swept[k].values.begin(), sweep.swept[k].values.end(),
                        [](const Json& value) { return value.is_number(); }))
            return k;
    return 0;
}

/// "ϕ = 0.56, friction static = 1": what the points of a curve have in common.
std::string curve_label(const std::vector<std::string>& names, std::size_t without, const Row& row)
{
    std::string text;
    for (std::size_t k = 0; k < names.size(); ++k) {
        if (k == without) continue;
        const std::string name = names[k] == "volume_fraction" ? "$ϕ$"
                                 : names[k] == "stress"        ? "$σ$/$σ$_{0}"
                                                               : spaced(names[k]);
        text += (text.empty() ? "" : ", ") + name + " = " + value_text(row.at(names[k]));
    }
    return text;
}

/// What numbers there are for a text on the axis: 1 for the first value, ...
double place_of(const Swept& swept, const Json& value)
{
    if (value.is_number()) return value.get<double>();
    const auto it = std::find(swept.values.begin(), swept.values.end(), value);
    return static_cast<double>(it - swept.values.begin() + 1);
}

bool is_wide(const std::vector<double>& values)
{
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return low != values.end() && *low > 0 && *high / *low >= wide;
}

void sort_by_x(render::Series& series)
{
    std::vector<std::size_t> order(series.x.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return series.x[a] < series.x[b]; });
    const render::Series unsorted = series;
    for (std::size_t k = 0; k < order.size(); ++k) {
        series.x[k] = unsorted.x[order[k]];
        series.y[k] = unsorted.y[order[k]];
        series.y_error[k] = unsorted.y_error[order[k]];
    }
    if (std::all_of(series.y_error.begin(), series.y_error.end(),
                    [](double error) { return error == 0; }))
        series.y_error.clear();
}

std::vector<render::Series> curves(const SweepFolder& sweep, const SweepTable& table,
                                   const std::string& column, std::size_t x)
{
    const std::vector<std::string> names = labels(sweep.sweep.swept);
    std::vector<render::Series> result;
    for (const Row& row : table.rows) {
        const double y = number_in(row, column), error = number_in(row, error_column(column));
        if (!std::isfinite(y)) continue;
        const std::string label = curve_label(names, x, row);
        auto it = std::find_if(result.begin(), result.end(),
                               [&](const render::Series& series) { return series.label == label; });
        if (it == result.end()) {
            it = result.insert(it, render::Series{});
            it->label = label;
            it->marker = render::Marker::circle;
        }
        it->x.push_back(place_of(sweep.sweep.swept[x], row.at(names[x])));
        it->y.push_back(y);
        it->y_error.push_back(std::isfinite(error) ? error : 0);
    }
    for (render::Series& series : result) sort_by_x(series);
    return result;
}

}

std::string drawn_column(const SweepTable& table, const std::string& wanted)
{
    if (!wanted.empty()) {
        for (const std::string& column : {wanted, wanted + std::string(mean_ending)})
            if (table.has(column)) return column;
        std::vector<std::string_view> known(table.columns.begin(), table.columns.end());
        const auto nearest = io::nearest_word(wanted, known);
        throw Error(ErrorKind::usage, "--y",
                    "must be a column of the table, got " + io::in_quotes(wanted) +
                        (nearest ? ", did you mean " + io::in_quotes(*nearest) + "?" : ""));
    }
    for (const char* ending : {".viscosity.mean", ".shear_rate.mean"}) {
        const auto last =
            std::find_if(table.columns.rbegin(), table.columns.rend(),
                         [&](const std::string& column) { return column.ends_with(ending); });
        if (last != table.columns.rend()) return *last;
    }
    return "";
}

std::optional<render::Plot> sweep_figure(const SweepFolder& sweep, const SweepTable& table,
                                         const std::string& column)
{
    if (sweep.sweep.swept.empty()) return std::nullopt;  // repeats of one point are no curve
    render::Plot plot = PictureSize().plot();
    const std::size_t x = abscissa(sweep.sweep);
    plot.series = curves(sweep, table, column, x);
    if (plot.series.empty()) return std::nullopt;
    const auto unit = table.units.find(column);
    plot.title = sweep.workflow.value("name", "") + ": " + column.substr(0, column.find('.'));
    plot.y.title = axis_title(quantity_of(column), unit == table.units.end() ? "" : unit->second);
    std::vector<double> all_x, all_y;
    for (const render::Series& series : plot.series) {
        all_x.insert(all_x.end(), series.x.begin(), series.x.end());
        all_y.insert(all_y.end(), series.y.begin(), series.y.end());
    }
    plot.x.logarithmic = is_wide(all_x);
    plot.y.logarithmic = is_wide(all_y);
    const Swept& swept = sweep.sweep.swept[x];
    plot.x.title = axis_title(labels(sweep.sweep.swept)[x], "");
    if (!swept.values.front().is_number()) {
        plot.x.title += " (";
        for (std::size_t k = 0; k < swept.values.size(); ++k)
            plot.x.title += (k ? ", " : "") + std::to_string(k + 1) + ": " +
                            std::filesystem::path(value_text(swept.values[k])).filename().string();
        plot.x.title += ")";
    }
    return plot;
}

}
