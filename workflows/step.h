// workflows/step.h -- what a step of a workflow is.
//
// A step is a struct with three functions:
//   void describe(io::Fields&)                       its parameters, each declared once
//   void validate(const io::JsonNode&, Plan&)        everything that can be wrong before computing
//   void run(Context&) const                         the work
// and one row in the list of steps.cpp. All steps are validated before the first one runs. Steps
// hand on their results through the context: the state of the suspension and the runs made so far.
#pragma once
#include "engine/frame.h"
#include "engine/model.h"
#include "engine/state.h"
#include "io/json_fields.h"
#include "io/run_file.h"
#include "workflows/progress.h"
#include "workflows/run_folder.h"
#include "workflows/suspension.h"

#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace sigmaflow::workflows {

class Keeper;

/// A shearing step that a later step can refer to.
struct PlannedRun {
    std::string name;
    Control control;
    int particles = 0;
    double volume_fraction = 0;
    double narrowest_box = 0, largest_radius = 0;  // [a]
    double strain = 0;
    double frames = 0;  // that later steps can use
};

/// What a step asks of the machine (workflows/forecast.h).
struct Needs {
    double particles = 0;                         // that it works on; 0: those of the last packing
    double volume_fraction = 0;                   // of what it shears; 0: it does not shear
    double samples = 0, frames = 0;               // that it writes
    double frames_read = 0;                       // that it holds in memory
    double drawn_pixels = 0, plotted_pixels = 0;  // of its picture: particles or curves

    bool draws() const { return drawn_pixels + plotted_pixels > 0; }
};

/// <name>.png of a step, unless it finds nothing to draw.
struct PlannedPicture {
    std::string name, step;
};

/// What is known while the steps are validated in their order.
struct Plan {
    const Suspension& suspension;
    bool has_suspension = true;    // workflows that begin with a stored run need none
    std::filesystem::path folder;  // of the workflow file: paths in it are relative to that
    std::string step_name;
    bool has_state = false;
    int particles = 0;                             // of the last packing
    double volume_fraction = 0;                    // likewise
    double narrowest_box = 0, largest_radius = 0;  // likewise [a]
    // set by the step that is validated:
    bool changes_state = false;
    std::vector<std::filesystem::path>
        inputs;  // files that it reads, beside those of earlier steps
    Needs needs;
    std::vector<std::string> uses;  // steps whose results it needs; none: the state
    // its pictures are <name><ending>.png; one without ending if it draws and there is none here
    std::vector<std::string> endings;

    std::vector<PlannedRun> runs;
    std::vector<PlannedPicture> pictures;
    std::vector<std::string> responses;  // steps "step_stress"

    /// Error(input) if no step before has made a packing.
    void need_state(const io::JsonNode& step) const;
    /// Error(input) if the workflow names no suspension.
    void need_suspension(const io::JsonNode& step) const;
    /// The run of the last packing that the step makes, with `frames` for later steps.
    PlannedRun shears(const Control& control, double strain, double frames) const;
    /// The run that the field `of` names, or the last one if it is empty, with frames if asked for;
    /// `of` and what the step needs and uses are filled in. Errors: input (no such run).
    const PlannedRun& need_run(const io::JsonNode& step, std::string& of, bool with_frames);
    /// For a step that has errors: all that it could have handed on is there, so that those of
    /// later steps are only their own.
    void assume_results();
};

/// Error(input) at the key if a strain is beyond the end of the run.
void check_within(const PlannedRun& run, const io::JsonNode& step, const char* key,
                  const std::optional<double>& strain);

/// A finished shearing step.
struct Run {
    std::string name;
    Control control;
    double volume_fraction = 0;
    int particles = 0;
    std::filesystem::path file;      // run.h5
    std::vector<Sample> series;      // at equal strain intervals
    std::optional<double> start_up;  // averages begin at this strain; none: no averages
    bool jammed = false;
    std::string continues;  // the run whose last state it started from; empty: a packing
};

/// A picture that could not be drawn.
struct Problem {
    std::string step, text;
};

/// What the steps work on and hand on.
struct Context {
    const Suspension& suspension;
    io::Provenance provenance;
    RunFolder& folder;
    Progress& progress;
    Keeper& keeper;
    int threads = 1;  // of each evaluation

    State state;
    std::vector<Run> runs;
    std::string last_run;  // that led to the state; empty: a packing did

    std::string step_name;           // of the step that is running
    nlohmann::ordered_json results;  // of the step that is running, for summary.json
    std::vector<Problem> problems;
    std::map<std::string, nlohmann::ordered_json> finished;  // results of the steps so far

    const Run& run(const std::string& name) const;
};

struct Step {
    std::string kind, name;
    bool changes_state = false;
    std::vector<std::filesystem::path> inputs;
    Needs needs;
    std::vector<std::string> uses;  // names of the steps that it depends on; none: the state
    std::string pointer;            // "/steps/2"
    std::function<void(io::Fields&)> describe;
    std::function<void(const io::JsonNode&, Plan&)> validate;
    std::function<void(Context&)> run;
};

/// A row of the list of steps.
struct StepKind {
    std::string_view name, summary;
    std::function<Step()> make;
};

template <class T>
StepKind step_kind(std::string_view name, std::string_view summary)
{
    return {name, summary, [name] {
                auto step = std::make_shared<T>();
                return Step{.kind = std::string(name),
                            .name = std::string(name),
                            .inputs = {},
                            .needs = {},
                            .uses = {},
                            .pointer = "",
                            .describe = [step](io::Fields& f) { step->describe(f); },
                            .validate = [step](const io::JsonNode& node,
                                               Plan& plan) { step->validate(node, plan); },
                            .run = [step](Context& context) { step->run(context); }};
            }};
}

}
