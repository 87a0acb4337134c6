// workflows/forecast.h -- what a run will need, and whether this machine has it.
//
// Memory: the largest step. Shearing is dominated by the sparse Cholesky factor of the outputs,
// whose size was measured (n = 500 ... 15 000, volume fraction 0.3 ... 0.58, peak of the resident
// set): 42 MB + 52 kB n^1.204 volume_fraction^1.765, from -29 % to +20 % of the peaks, which depend
// on the order that CHOLMOD chooses. Disk: series and frames, each frame 1.1 kB for a particle in
// the thickened state (HDF5, VTK and the journal, which goes at the end), 0.7 kB in a dilute one.
#pragma once
#include "workflows/step.h"

#include <filesystem>
#include <optional>
#include <string>

namespace sigmaflow::workflows {

struct Workflow;
struct Resumption;

struct Forecast {
    double memory = 0;  // [B], peak of the resident set
    std::string step;   // that needs most memory
    double disk = 0;    // [B], while it runs
};

/// What the steps need that are still to be run; a step that goes on needs less disk. All steps if
/// there is no plan.
Forecast forecast(const Workflow& workflow, const Resumption* plan = nullptr);

struct Room {
    std::optional<double> memory;  // [B]; nothing: unknown
    std::string memory_limit;      // what sets it
    std::optional<double> disk;    // [B]
};

/// Memory: the least of what the system has left, the limits of the control groups, and the limit
/// of the address space of this process (ulimit -v). Disk: of the file system of the folder.
Room room_here(const std::filesystem::path& folder);

/// Errors: input at suspension/particles (memory), no_space (disk).
void check_room(const Forecast& needed, const Room& room, const io::JsonNode& workflow,
                const std::filesystem::path& folder);

/// "430 MB of memory and 1.2 GB on disk".
std::string forecast_text(const Forecast& needed);

}
