// workflows/past_run.h -- what a run has left in its folder, read back from manifest.json and
// summary.json; the run may be finished, interrupted, failed or still going on.
//
// Errors: missing (no such folder, unreadable file), input (not the folder of a run; damaged JSON
// and what is not as the program writes it, with file:line:column).
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace sigmaflow::workflows {

struct PastFile {
    std::string name;  // relative to the folder of the run; leads to nowhere else
    double size = 0;   // bytes
    bool exists = false;
};

struct PastStep {
    std::string name, kind;
    nlohmann::ordered_json parameters;  // with all defaults
    nlohmann::ordered_json results;     // of summary.json; null: not finished
    std::optional<double> wall_seconds;
    std::vector<PastFile> files;

    /// Those of its files that end so: ".png".
    std::vector<PastFile> files_ending(const std::string& ending) const;
    bool has_means() const;
};

struct PastRun {
    std::filesystem::path folder;
    nlohmann::ordered_json manifest;  // status, workflow, seed, host, ...
    std::vector<PastStep> steps;      // of the workflow, in its order
    std::vector<PastFile> files;      // that belong to no step

    std::string title() const;
    std::string description() const;
};

PastRun read_past_run(const std::filesystem::path& folder);

/// Steps that are told together: neighbours of one kind that differ in one parameter at most and
/// draw nothing, as those of a sweep. All others are alone.
struct Chapter {
    std::size_t first = 0, count = 1;
    std::string parameter;  // that differs; empty: alone
};

std::vector<Chapter> chapters(const PastRun& run);

}
