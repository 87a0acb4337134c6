// workflows/snakemake.h -- a sweep as a Snakefile: a rule for the points, one for the table.
//
// A point is done when points/<name>.done is there: snakemake removes the outputs of rules that
// failed, and what a point needs to go on must stay. Likewise table.done stands for the table,
// which can also be collected before all points are done.
#pragma once
#include "workflows/sweep_run.h"

namespace sigmaflow::workflows {

std::string snakefile(const SweepFolder& sweep, const SweepOptions& options,
                      const std::filesystem::path& program);

/// Writes it; returns how it is run.
std::string write_snakefile(const SweepFolder& sweep, const SweepOptions& options);

}
