// workflows/report.h -- results as short text for people.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace sigmaflow::workflows {

/// The outcome of one step in a few words, for the progress on the screen.
std::string one_line(const nlohmann::ordered_json& step_summary);

/// Every mean in summary.json with its standard error, aligned.
std::string table(const nlohmann::ordered_json& summary);

/// Is this entry of a summary {"mean": ..., "standard_error": ..., "unit": ...}?
bool is_mean(const nlohmann::ordered_json& entry);

/// Its mean with its error, without the unit.
std::string mean_text(const nlohmann::ordered_json& entry, const std::string& between = " +- ");

/// "0.0192 +- 0.0011": the error with two significant digits, the value with as many decimals.
std::string with_error(double value, double error, const std::string& between = " +- ");

}
