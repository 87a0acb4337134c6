// workflows/point_status.h -- how far the points of a sweep are, read from their folders.
//
// manifest.json tells what has ended well, the last line of the log ("exit code 70") what has not,
// and the kernel's lock on the folder of a run that it is going on here. A run that left neither
// was killed and goes on from its checkpoint.
#pragma once
#include "workflows/sweep_folder.h"

#include <optional>

namespace sigmaflow::workflows {

enum class PointState { waiting, running, interrupted, complete, failed };

std::string_view word_of(PointState state);

struct PointStatus {
    PointState state = PointState::waiting;
    std::optional<int> exit_code;                                     // of a failed point
    std::string message;                                              // what it said then
    bool queued = false;                                              // waits or runs in Slurm
    nlohmann::ordered_json steps = nlohmann::ordered_json::object();  // of its summary.json
};

/// Of all points, in their order. Files that cannot be read count as not there.
std::vector<PointStatus> read_status(const SweepFolder& sweep);

/// "5 complete, 1 failed, 2 running, 1 waiting": what there is of each.
std::string count_text(const std::vector<PointStatus>& status);

/// "exit code 70, <message>" of a failed point.
std::string failure_text(const PointStatus& status);

/// The last message of an error in a log, without "sigmaflow: error: ".
std::string last_error_in(const std::string& log);

}
