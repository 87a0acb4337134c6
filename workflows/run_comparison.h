// workflows/run_comparison.h -- where two runs differ.
//
// Two folders: parameters (of the resolved workflows), the time series of every step that both
// have, and the numbers and words of summary.json. Two files: series.csv or run.h5 (their series,
// also one against the other), or two summary.json.
//
// Numbers a and b are equal if |a - b| <= tolerance max(|a|, |b|); tolerance 0: bit by bit. Rows of
// two series are compared where both have the same strain; rows that only one has (another
// interval) are counted, and the runs differ if one ends at another strain. Parameters are told but
// make no difference by themselves. With a tolerance, what says how it was computed ("steps",
// "solver" in a summary) is left out.
// Errors: missing (not there), input (damaged, of different kinds, or without a common strain).
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sigmaflow::workflows {

/// One column of a series.
struct QuantityDifference {
    std::string name;
    std::size_t row = 0, rows = 0;  // the first row of the first series that differs; how many do
    double strain = 0;              // of that row
    double a = 0, b = 0;            // there
    double largest = 0, largest_strain = 0;  // relative difference
};

struct SeriesComparison {
    std::string name;  // "shear", or the file
    std::size_t rows_a = 0, rows_b = 0, common = 0;
    double end_a = 0, end_b = 0;                 // strain
    std::vector<QuantityDifference> quantities;  // that differ, the first one first

    bool equal() const { return quantities.empty() && end_a == end_b; }
};

struct ValueDifference {
    std::string place;            // JSON pointer
    nlohmann::ordered_json a, b;  // null: not there
};

struct RunComparison {
    double tolerance = 0;
    std::vector<ValueDifference> parameters, results;
    std::vector<SeriesComparison> series;

    bool equal() const;
};

RunComparison compare_runs(const std::filesystem::path& a, const std::filesystem::path& b,
                           double tolerance);

std::string comparison_text(const RunComparison& comparison);
nlohmann::ordered_json comparison_json(const RunComparison& comparison);

}
