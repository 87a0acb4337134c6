// workflows/sweep_figure.h -- a column of the table of a sweep as curves.
#pragma once
#include "render/line_plot.h"
#include "workflows/sweep_table.h"

#include <optional>

namespace sigmaflow::workflows {

/// The column that is drawn: `wanted`, "shear.viscosity" standing for "shear.viscosity.mean";
/// without a wish the viscosity of the last step that has one, else its shear rate; empty: there
/// is none. Errors: usage (no such column; the nearest one is named).
std::string drawn_column(const SweepTable& table, const std::string& wanted);

/// Against the first swept parameter with numbers, or the numbers 1, 2, ... of its values, one
/// curve for each combination of the other parameters. Logarithmic axes where all is positive and
/// spans a factor of ten. Nothing: no point has a number yet, or nothing
/// is swept.
std::optional<render::Plot> sweep_figure(const SweepFolder& sweep, const SweepTable& table,
                                         const std::string& column);

}
