// engine/step.h -- time stepping: Euler, Heun (predictor-corrector) and a linearly implicit scheme.
//
// Box, particles and springs move with the same averaged rates. Euler and Heun are explicit: their
// step is bound by the stiffness of the contacts. The implicit scheme is BDF2 with variable steps
// (Gear, Numerical Initial Value Problems in Ordinary Differential Equations, 1971; variable steps:
// Grigorieff, Numer. Math. 42, 359, 1983), linearised about a prediction, with the springs of
// contacts and repulsion in the matrix (engine/implicit.cpp): one solve a step, second order for
// smooth motion, L-stable for linear springs. Friction is not smooth: there the error is of first
// order with a small coefficient, as for Heun. It leans on the step before, which the workspace
// remembers; without one a step is of first order (backward Euler).
#pragma once
#include "engine/evaluation.h"
#include "engine/model.h"
#include "engine/state.h"

#include <limits>

namespace sigmaflow {

enum class Scheme { euler, heun, implicit };
enum class March { time, strain };

struct Stepping {
    Scheme scheme = Scheme::heun;
    double displacement = 1e-3;  // nothing moves by much more than this in a step [a] > 0
};

/// Where a step has to stop at the latest.
struct StepLimit {
    double strain = std::numeric_limits<double>::infinity();
    double time = std::numeric_limits<double>::infinity();
};

// No step leaves a state that is not finite (checks.h). A step that throws leaves the state as it
// was, and a workspace that is as good as a new one.

/// One explicit step of length h in time [1/rate0] or in strain [-]; `first` is the evaluation of
/// `state`. Strain marching divides by the rates of the stages: it needs them positive.
void step(State& state, const Model& model, const Control& control, Scheme scheme, March march,
          double h, const Evaluation& first, Workspace& workspace);

/// Longest time in which nothing moves by more than `displacement` [1/rate0].
double displacement_time_step(const Evaluation& evaluation, double displacement);

/// Longest time step for which sticking contacts stay stable, 25 eta0 a/kt and at most the
/// relaxation time of the contacts: the fastest mode is a sticking contact being turned, with a
/// relaxation rate of 0.034 kt/(eta0 a) at delta = 1e-3 (measured), and Euler and Heun are stable
/// up to 2 over that rate.
double stable_time_step(const Evaluation& evaluation);

/// One implicit step of length dt. If it would pass the strain limit by a few per cent at most, its
/// velocities act for less time, so that the step lands on it. Returns the evaluation at its
/// (predicted) end.
Evaluation implicit_step(State& state, const Model& model, const Control& control, double dt,
                         double strain_limit, Workspace& workspace);

/// One adaptive step, shortened to land on the limits exactly; `first` is the evaluation of
/// `state`, if it is known already. The shear rate may be negative for a while; then the box goes
/// back. Returns an evaluation of the step: at its beginning, or at the end of an implicit one.
Evaluation advance(State& state, const Model& model, const Control& control,
                   const Stepping& stepping, const StepLimit& limit, Workspace& workspace,
                   const Evaluation* first = nullptr);

}
