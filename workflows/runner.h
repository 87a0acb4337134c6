// workflows/runner.h -- runs the steps of a workflow one after the other.
#pragma once
#include "io/json_override.h"

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <vector>

namespace sigmaflow::workflows {

struct RunOptions {
    std::filesystem::path workflow;            // the JSON file
    std::vector<io::Override> overrides;       // of values in it
    std::optional<std::filesystem::path> out;  // default: out/<name of the file>
    bool quiet = false;                        // no progress on stderr
    bool json = false;                         // events on stdout instead of the table
    int threads = 1;                           // results do not depend on it
    bool force = false;                        // nothing of an earlier run is used
    double checkpoint_interval = 30;           // [s] >= 0
    std::optional<double> wall_time;           // the program ends before [s]
};

/// Runs the workflow, or what is left of it (workflows/resumption.h), and prints a short table of
/// results. manifest.json and summary.json are written atomically, the summary after every step;
/// resolved.json is a workflow file that repeats the run: all defaults and overrides filled in.
/// Errors: missing, input (before anything is computed), file, no_space, locked, numerics,
/// interrupted; rendering after everything else is complete.
void run_workflow(const RunOptions& options, std::ostream& results);

}
