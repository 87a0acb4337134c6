// workflows/collect.h -- table and figure of what a sweep has reached, at any time.
#pragma once
#include "workflows/point_status.h"

namespace sigmaflow::workflows {

/// Writes table.csv (one row for each combination of values; with repeats also runs.csv, one row
/// for each run) and a figure of `quantity`, a column of the table, against the first swept
/// parameter that has numbers, one curve for each combination of the others, as .svg and .png.
/// Without a quantity: the viscosity of the last step that has one, else the shear rate. Returns
/// what is to be said: counts, failures, names of the files. Errors: usage (no such quantity),
/// file, rendering.
std::string collect_sweep(const SweepFolder& sweep, const std::vector<PointStatus>& status,
                          const std::string& quantity);

}
