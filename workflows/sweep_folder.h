// workflows/sweep_folder.h -- the folder of a sweep, and what it holds for later.
//
//   workflow.json      the workflow, frozen when the sweep began
//   sweep.json         what is swept; the points and the command of each, to be given in the folder
//   points/<name>/     the run of a point, points/<name>.log what it said
//   table.csv, ...     what `collect` makes of them (workflows/collect.h)
//   sweep.lock         the kernel's lock of the process that works on the sweep, and its name
//
// A sweep goes on with the parameters that it began with; only values, repeats and nothing else can
// be added. Errors: file, locked, missing, input (sweep.json is damaged, other parameters).
#pragma once
#include "workflows/sweep.h"

namespace sigmaflow::workflows {

inline constexpr const char* frozen_name = "workflow.json";
inline constexpr const char* sweep_name = "sweep.json";
inline constexpr const char* points_name = "points";

struct SweepFolder {
    std::filesystem::path path, source;  // of the sweep; of the original workflow file
    nlohmann::ordered_json workflow;     // frozen
    Sweep sweep;
    std::vector<Point> points;

    std::filesystem::path run_of(const Point& point) const;
    std::filesystem::path log_of(const Point& point) const;
};

/// The arguments of `sigmaflow` that run a point, in the folder of the sweep.
std::vector<std::string> run_arguments(const Point& point);

/// A command line for a shell: every word that needs it in quotes.
std::string shell_line(const std::vector<std::string>& words);

bool holds_sweep(const std::filesystem::path& folder);
SweepFolder read_sweep(const std::filesystem::path& folder);
/// workflow.json, sweep.json and the folder points.
void write_sweep(const SweepFolder& sweep);

/// Error(input) with old and new value if `now` is not the sweep of before with more values.
void refuse_other_sweep(const SweepFolder& before, const SweepFolder& now);

/// Keeps other sweeps out of the folder, which is made; ends with the process.
class SweepLock {
public:
    explicit SweepLock(const std::filesystem::path& folder);
    ~SweepLock();
    SweepLock(const SweepLock&) = delete;
    SweepLock& operator=(const SweepLock&) = delete;

private:
    int descriptor_ = -1;
};

}
