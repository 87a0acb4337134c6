// engine/step.h -- time stepping: Euler and the consistent predictor-corrector (Heun).
//
// Box, particles and springs move with the same averaged rates; the velocities are functions of the
// state (engine/README.md, section "Time stepping").
#pragma once
#include "engine/evaluation.h"
#include "engine/model.h"
#include "engine/state.h"

#include <limits>

namespace sigmaflow {

enum class Scheme { euler, heun };
enum class March { time, strain };

struct Stepping {
    Scheme scheme = Scheme::heun;
    double displacement = 1e-3;  // nothing moves by more than this in a step [a] > 0
};

/// Where a step has to stop at the latest.
struct StepLimit {
    double strain = std::numeric_limits<double>::infinity();
    double time = std::numeric_limits<double>::infinity();
};

/// One step of length h in time [1/rate0] or in strain [-]; `first` is the evaluation of `state`.
/// Strain marching divides by the rates of the stages: it needs them positive.
void step(State& state, const Model& model, const Control& control, Scheme scheme, March march,
          double h, const Evaluation& first, Workspace& workspace);

/// Longest time in which nothing moves by more than `displacement` [1/rate0].
double displacement_time_step(const Evaluation& evaluation, double displacement);

/// Longest time step for which sticking contacts stay stable, 25 eta0 a/kt and at most the
/// relaxation time of the contacts: the fastest mode is a sticking contact being turned, with a
/// relaxation rate of 0.034 kt/(eta0 a) at delta = 1e-3 (measured), and Euler and Heun are stable
/// up to 2 over that rate.
double stable_time_step(const Evaluation& evaluation);

/// One adaptive step, shortened to land on the limits exactly; `first` is the evaluation of
/// `state`. The shear rate may be negative for a while; then the box goes back.
void advance(State& state, const Model& model, const Control& control, const Stepping& stepping,
             const StepLimit& limit, const Evaluation& first, Workspace& workspace);

}
