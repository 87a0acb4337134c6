// workflows/report.h -- results as short text for people.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace sigmaflow::workflows {

/// The outcome of one step in a few words, for the progress on the screen.
std::string one_line(const nlohmann::ordered_json& step_summary);

/// Every mean in summary.json with its standard error, aligned.
std::string table(const nlohmann::ordered_json& summary);

/// "0.0192 +- 0.0011": the error with two significant digits, the value with as many decimals.
std::string with_error(double value, double error, const std::string& between = " +- ");

}
