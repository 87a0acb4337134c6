// workflows/page_values.h -- entries of a summary as HTML, whatever they are.
//
// A number stands in <data value="...">, which keeps it as summary.json has it, while people see it
// rounded: means to the two digits of their error (workflows/report.h), others to four digits.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace sigmaflow::workflows {

/// "shear_rate" is "shear rate".
std::string in_words(const std::string& key);

/// One value as HTML: a number, a mean with its error and unit, a text, a list, a table.
std::string value_html(const nlohmann::ordered_json& value);

/// The mean of a summary with its error, without the unit.
std::string mean_html(const nlohmann::ordered_json& entry);

/// All of a step's numbers: a table of its means, one of what else there is.
std::string results_html(const nlohmann::ordered_json& results);

/// What a step says in words: {"outcome", "jammed"}, {"errors reliable", "no"}, and of its lists
/// {"volume fraction 0.58: shape", "S-shaped"}. Plain text.
using Verdicts = std::vector<std::pair<std::string, std::string>>;
Verdicts verdicts_of(const nlohmann::ordered_json& results);

/// Size of a file for people: "12 kB".
std::string size_text(double bytes);

}
