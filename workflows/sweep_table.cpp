#include "workflows/sweep_table.h"

#include "workflows/report.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow::workflows {

using Json = nlohmann::ordered_json;

namespace {

constexpr std::string_view mean_ending = ".mean", error_ending = ".standard_error";

/// Numbers of a step; lists, words and settings of solvers are for the summary only.
void add_numbers(SweepTable& table, std::map<std::string, Json>& row, const std::string& name,
                 const Json& value)
{
    if (value.is_number()) {
        if (!table.has(name)) table.columns.push_back(name);
        row[name] = value;
    } else if (is_mean(value)) {
        for (const std::string_view ending : {mean_ending, error_ending}) {
            const auto it = value.find(std::string(ending.substr(1)));
            if (it == value.end()) continue;
            const std::string column = name + std::string(ending);
            add_numbers(table, row, column, *it);
            if (const auto unit = value.find("unit"); unit != value.end() && unit->is_string())
                table.units[column] = unit->get<std::string>();
        }
    } else if (value.is_object()) {
        for (const auto& [key, inner] : value.items())
            add_numbers(table, row, name + "." + key, inner);
    }
}

std::string outcome_of(const Json& steps)
{
    std::string outcome;
    for (const auto& step : steps)
        if (step.is_object() && step.contains("outcome") && step["outcome"].is_string())
            outcome = step["outcome"].get<std::string>();
    return outcome;
}

std::vector<double> column_of(const SweepTable& runs, const std::vector<std::size_t>& rows,
                              const std::string& column)
{
    std::vector<double> values;
    for (const std::size_t k : rows) {
        const auto it = runs.rows[k].find(column);
        if (it != runs.rows[k].end() && it->second.is_number())
            values.push_back(it->second.get<double>());
    }
    return values;
}

std::string quoted(const std::string& text)
{
    if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
    std::string result = "\"";
    for (const char c : text) result += c == '"' ? "\"\"" : std::string(1, c);
    return result + "\"";
}

/// The mean of a column over runs and its error, under the names that one run would give them.
void add_mean(SweepTable& table, std::map<std::string, Json>& row, const std::string& column,
              const std::vector<double>& values)
{
    const auto n = static_cast<double>(values.size());
    double mean = 0, squares = 0;
    for (const double value : values) mean += value / n;
    for (const double value : values) squares += (value - mean) * (value - mean);
    std::string error = column;
    if (error.ends_with(mean_ending)) error.resize(error.size() - mean_ending.size());
    error += error_ending;
    for (const std::string& name : {column, error})
        if (!table.has(name)) table.columns.push_back(name);
    row[column] = mean;
    if (values.size() > 1) row[error] = std::sqrt(squares / (n * (n - 1)));
}

}

bool SweepTable::has(const std::string& column) const
{
    return std::find(columns.begin(), columns.end(), column) != columns.end();
}

SweepTable run_table(const SweepFolder& sweep, const std::vector<PointStatus>& status)
{
    const std::vector<std::string> names = labels(sweep.sweep.swept);
    SweepTable table;
    table.columns = {"point"};
    table.columns.insert(table.columns.end(), names.begin(), names.end());
    if (sweep.sweep.repeats > 1) table.columns.push_back("repeat");
    for (const char* column : {"status", "exit_code", "outcome", "message"})
        table.columns.push_back(column);
    for (std::size_t k = 0; k < sweep.points.size(); ++k) {
        const Point& point = sweep.points[k];
        std::map<std::string, Json> row;
        row["point"] = point.name;
        for (std::size_t i = 0; i < names.size(); ++i) row[names[i]] = point.values[i];
        row["repeat"] = point.repeat;
        row["status"] = word_of(status[k].state);
        if (status[k].exit_code) row["exit_code"] = *status[k].exit_code;
        row["outcome"] = outcome_of(status[k].steps);
        row["message"] = status[k].message;
        for (const auto& [step, results] : status[k].steps.items())
            add_numbers(table, row, step, results);
        table.rows.push_back(std::move(row));
    }
    return table;
}

SweepTable over_repeats(const SweepFolder& sweep, const std::vector<PointStatus>& status,
                        const SweepTable& runs)
{
    const std::vector<std::string> names = labels(sweep.sweep.swept);
    SweepTable table;
    table.units = runs.units;
    table.columns = {"point"};
    table.columns.insert(table.columns.end(), names.begin(), names.end());
    table.columns.insert(table.columns.end(), {"status", "repeats"});
    const auto first_number = std::find(runs.columns.begin(), runs.columns.end(), "message") + 1;
    for (std::size_t k = 0; k < sweep.points.size();) {
        std::vector<PointStatus> all;
        std::vector<std::size_t> complete;
        std::map<std::string, Json> row = runs.rows[k];
        for (bool first = true; k < sweep.points.size() && (first || sweep.points[k].repeat > 1);
             ++k, first = false) {
            all.push_back(status[k]);
            if (status[k].state == PointState::complete) complete.push_back(k);
        }
        std::erase_if(row, [&](const auto& cell) { return !table.has(cell.first); });
        row["status"] = count_text(all);
        row["repeats"] = complete.size();
        for (auto column = first_number; column != runs.columns.end(); ++column) {
            const std::vector<double> values = column_of(runs, complete, *column);
            if (!column->ends_with(error_ending) && !values.empty())
                add_mean(table, row, *column, values);
        }
        table.rows.push_back(std::move(row));
    }
    return table;
}

std::string csv_text(const SweepTable& table)
{
    std::string text =
        "# <step>.<quantity> of summary.json, standard_error: of the mean; empty: not known\n";
    for (const std::string& column : table.columns)
        text += (&column == &table.columns.front() ? "" : ",") + quoted(column);
    text += "\n";
    for (const auto& row : table.rows) {
        for (const std::string& column : table.columns) {
            if (&column != &table.columns.front()) text += ',';
            const auto it = row.find(column);
            if (it != row.end() && !it->second.is_null()) text += quoted(value_text(it->second));
        }
        text += "\n";
    }
    return text;
}

}
