// workflows/sweep_table.h -- the numbers of a sweep as a table.
//
// Columns: point, the swept parameters, status, exit_code, outcome (of the last run that has one),
// message, and every number of summary.json as "<step>.<quantity>", of a mean
// "<step>.<quantity>.mean" and ".standard_error".
#pragma once
#include "workflows/point_status.h"

#include <map>

namespace sigmaflow::workflows {

struct SweepTable {
    std::vector<std::string> columns;  // texts and numbers
    std::vector<std::map<std::string, nlohmann::ordered_json>>
        rows;                                  // what is not there is unknown
    std::map<std::string, std::string> units;  // of columns that have one

    bool has(const std::string& column) const;
};

/// One row for each run.
SweepTable run_table(const SweepFolder& sweep, const std::vector<PointStatus>& status);

/// One row for each combination of values, over its repeats: "repeats" tells how many are complete,
/// and only these count. Means are means over runs, standard errors come from their scatter,
/// sqrt(sum (x - mean)^2 / (n (n - 1))), and there are none for one run.
SweepTable over_repeats(const SweepFolder& sweep, const std::vector<PointStatus>& status,
                        const SweepTable& runs);

/// With a first line that explains the columns; fields with commas, quotes or line breaks in quotes
/// (RFC 4180).
std::string csv_text(const SweepTable& table);

}
