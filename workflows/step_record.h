// workflows/step_record.h -- what a finished step leaves for later runs: it need not run again.
//
// .sigmaflow/<step>.step holds the identity of the step, what it handed on, and its files with
// their checksums. It is written last: a record exists only when everything it names is complete.
// Errors: file, no_space; reading: missing, input.
#pragma once
#include "workflows/run_folder.h"
#include "workflows/workflow.h"

#include <optional>
#include <string>
#include <vector>

namespace sigmaflow::workflows {

/// Results change with this number; to be raised with every change of the numerics.
inline constexpr int numerics_version = 1;

/// Everything that the result of a step depends on.
struct StepIdentity {
    std::string name, kind;
    std::string parameters;  // of the step, JSON with all defaults
    std::string suspension;  // JSON with all defaults
    int numerics = numerics_version;
    std::string key;  // hash of all that and of the steps before on which it depends
};

template <class Archive>
void archive(Archive& a, StepIdentity& s)
{
    a(s.name, s.kind, s.parameters, s.suspension, s.numerics, s.key);
}

/// One for every step of the workflow.
std::vector<StepIdentity> identities(const Workflow& workflow);

template <class Archive>
void archive(Archive& a, Run& run)
{
    std::string file = run.file.string();
    a(run.name, run.control, run.volume_fraction, run.particles, file, run.series, run.start_up,
      run.jammed, run.continues);
    run.file = file;
}

struct StepRecord {
    StepIdentity identity;
    std::string results;  // JSON, for summary.json
    double wall_seconds = 0;
    std::vector<ResultFile> files;
    std::optional<State> state;  // if the step changes it
    std::optional<Run> run;      // if it made one; without its file, if that is <step>/run.h5
    std::string last_run;        // after the step
};

template <class Archive>
void archive(Archive& a, StepRecord& r)
{
    a(r.identity, r.results, r.wall_seconds, r.files, r.state, r.run, r.last_run);
}

inline constexpr const char* record_ending = ".step";
std::filesystem::path record_path(const RunFolder& folder, const std::string& step);
void write_record(const RunFolder& folder, const StepRecord& record);
StepRecord read_record(const std::filesystem::path& path);

/// "stress was 2, is 3; strain was 5, is 8": where two JSON objects differ; empty if they do not.
std::string changes(const std::string& old_json, const std::string& new_json);

}
