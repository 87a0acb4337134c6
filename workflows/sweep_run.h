// workflows/sweep_run.h -- begins or goes on with a sweep.
#pragma once
#include "workflows/sweep_folder.h"

#include <iosfwd>
#include <optional>

namespace sigmaflow::workflows {

enum class Engine { local, slurm, snakemake };

struct SweepOptions {
    std::filesystem::path given;               // a workflow file, or the folder of a sweep
    std::optional<std::filesystem::path> out;  // default: out/<name of the file>_sweep
    std::vector<std::string> swept;            // of --sweep
    std::vector<io::Override> settings;
    std::optional<int> repeats;
    std::optional<Engine> engine;     // default: local, or Slurm if the sweep was submitted
    int jobs = 0;                     // at a time; 0: cores over threads, or no limit in Slurm
    int threads = 1;                  // of each point
    double checkpoint_interval = 30;  // [s]
    std::optional<double> wall_time;  // of the local engine [s]
    bool quiet = false;
    std::string slurm_options;
    bool submit = true;
    std::string quantity;  // of the figure; empty: chosen
};

/// The sweep that the options ask for. Every point is checked. Writes nothing. Errors: usage,
/// missing, input (all of all points, each kind once).
SweepFolder planned_sweep(const SweepOptions& options);

/// Runs all points that are not complete, or has an engine do it, and prints what there is.
/// Errors: those of planned_sweep; file, locked; interrupted; the kind of the worst failure of a
/// point, after all others have run.
void run_sweep(const SweepOptions& options, std::ostream& results);

}
