// workflows/shearing.h -- the loop that shears a suspension, shared by all shearing steps.
//
// evaluate -> output if one is due -> advance to the next output at the latest. Samples and frames
// are made exactly at multiples of their strain intervals, the first at strain 0 and the last at
// the end. The strain and the time of the state count from the beginning of the step. Between two
// steps everything that the next one depends on can be stored (workflows/checkpoint.h).
#pragma once
#include "engine/archive.h"
#include "engine/evaluation.h"
#include "engine/jamming.h"
#include "engine/step.h"
#include "io/model_fields.h"
#include "workflows/run_files.h"
#include "workflows/step.h"

#include <algorithm>
#include <functional>
#include <optional>

namespace sigmaflow::workflows {

struct ShearingTask {
    Model model;
    Control control;
    Stepping stepping;
    SolverSettings solver;
    double strain = 0;           // the end [-]
    double time = 0;             // at the latest [1/rate0]
    double series_interval = 0;  // [-]
    double frame_interval = 0;   // [-]; 0: only the last frame, if frames are made at all
};

void describe_scheme(io::Fields& f, Scheme& scheme);
/// Error(input) if the scheme cannot do the contacts of the model.
void check_scheme(Scheme scheme, const Model& model, const io::JsonNode& step);

/// Parameters that every shearing step has.
struct ShearingParameters {
    std::optional<double> stress, rate;
    Scheme scheme = Scheme::implicit;
    std::optional<double> displacement;
    SolverKind solver = SolverKind::pcg;
    std::optional<double> solver_tolerance;
    double series_interval = 0.01;
    std::optional<double> maximum_time;
    io::ModelChanges model;

    void describe(io::Fields& f);
    /// Exactly one of stress and rate, allowed by the model; the length in range of the interval.
    /// Notes in the plan what the step needs, but for frames.
    Control check(const io::JsonNode& node, Plan& plan, double strain) const;
    /// The time [1/rate0] after which the step ends in any case: maximum_time, or what the strain
    /// takes at a viscosity of 1e5 eta0 (stress control), or a little more than it takes (rate
    /// control).
    double time_limit(double strain) const;
    ShearingTask task(const Model& of_suspension, double strain, double frame_interval,
                      int threads) const;
};

/// flowing: reached its strain; jammed: engine/jamming.h; undecided: ran out of time. A jammed
/// suspension is a result, not an error.
enum class Outcome { flowing, jammed, undecided };
std::string_view outcome_name(Outcome outcome);

template <class Archive>
void archive(Archive& a, Outcome& outcome)
{
    int number = static_cast<int>(outcome);
    a(number);
    if (number < 0 || number > static_cast<int>(Outcome::undecided))
        ArchiveReader::refuse("has an unknown outcome");
    outcome = static_cast<Outcome>(number);
}

/// What the solver needed in the steps; solutions for outputs are not counted.
struct SolverStatistics {
    double iterations = 0;
    double largest_residual = 0;
    long fall_backs = 0;

    void add(const SolveReport& report)
    {
        iterations += report.iterations;
        largest_residual = std::max(largest_residual, report.residual);
        fall_backs += report.fell_back;
    }
};

struct ShearingResult {
    Outcome outcome = Outcome::undecided;
    long steps = 0;
    SolverStatistics solver;
    std::optional<JammingWindow> window;  // the last complete one, under an imposed stress
};

template <class Archive>
void archive(Archive& a, SolverStatistics& s)
{
    a(s.iterations, s.largest_residual, s.fall_backs);
}

/// Shears the state of the context, from its checkpoint if there is one. `enough` is asked after
/// each sample on the grid; true ends the run. Errors: numerics, with strain and step number as
/// context and the last good state in a file; interrupted, after a checkpoint.
ShearingResult shear(Context& context, const ShearingTask& task, RunFiles& files,
                     const std::function<bool()>& enough = {});

/// A run that leaves no files.
struct Trial {
    ShearingResult result;
    std::vector<Sample> series;  // on the grid, and the last one
};

/// Shears the state in memory, its strain and time from 0. `after_step` may throw. Different states
/// can be sheared at the same time. Errors: numerics.
Trial try_shear(State& state, const ShearingTask& task, const std::function<void()>& after_step);

/// {"outcome", "strain", "time", "steps", "jamming_window"} of a finished run, for summary.json.
nlohmann::ordered_json shearing_json(const State& state, const ShearingResult& result);

}
