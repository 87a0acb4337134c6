// workflows/run_status.h -- how far the run in a folder is, read from its files alone.
//
// Nothing is locked or written, so it can be asked at any time. While a step runs, its strain is
// that of the last row of series.csv. The time left in it comes from the strain gained between the
// two checkpoints, or since the step began if there is only one or none (not known of a step that
// went on from an earlier run).
// Errors: missing (no such folder), input (not the folder of a run).
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace sigmaflow::workflows {

struct StepStatus {
    std::string name, kind;
    std::string state;    // done, running, interrupted, failed, to do
    std::string outcome;  // of a finished step, in a few words
    std::optional<double> wall_seconds;
};

struct StoredPoint {
    std::string step, written;  // when, UTC
    double strain = 0;
    std::optional<double> share;  // of the step
};

struct RunStatus {
    std::string folder, workflow, workflow_file;
    // running; complete, pictures missing, interrupted, failed; killed: it ended without a word;
    // unknown: it says running, on another host
    std::string state;
    std::string owner;  // "process 4711 on host", that writes or wrote last
    std::string started, ended, error;
    std::vector<StepStatus> steps;
    std::optional<StoredPoint> checkpoint;
    std::optional<double> strain, share;      // of the running step, now
    std::optional<double> step_seconds_left;  // of the running step
    std::string next;                         // the command to type
};

RunStatus status_of(const std::filesystem::path& folder);

std::string status_text(const RunStatus& status);
nlohmann::ordered_json status_json(const RunStatus& status);

}
