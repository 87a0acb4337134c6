// engine/one_dimensional_flow.h -- flow across a gap with inertia and a microstructure that
// remembers the stress, integrated in time: what the linear theory of engine/stability.h leaves
// out.
//
// Momentum of unidirectional flow u(y, t), rho du/dt = d stress/dy, for the local rate
//
//   rho d rate/dt = d^2 stress/dy^2,
//
// in a gap 0 < y < H with modes of the wave number k,
//
//   imposed stress  at both walls:                     sin(m pi y/H), k = m pi/H
//   imposed rate    walls move with imposed speeds:    cos(m pi y/H), k = m pi/H
//   periodic        with the mean rate imposed:        cos(2 pi m y/H), k = 2 pi m/H
//
// With the mean rate imposed there is also k = 0, which inertia does not damp: on a falling branch
// the stress of uniform flow leaves it as a whole (growth_at_imposed_rate in engine/stability.h).
// The paper's onset, with k = pi/H as the smallest wave number, is that of an imposed stress. The
// stress follows from the rate and the microstructure by a Constitution (engine/constitution.h).
//
// Everything is over a base state: rates over its rate, stresses over its stress, y over H, times
// over 1/rate, velocities over rate H; then rho becomes the Reynolds number Re.
// Numbers: finite volumes of equal size, rates and parts at centres, velocities at faces. Time:
// two-stage implicit Runge-Kutta method of order 2, L-stable (Alexander, SIAM J. Numer. Anal. 14,
// 1006, 1977), Newton's method for the stresses of all volumes at once. A step that does not
// converge is divided.
//
// Tests: growth and frequency against the roots on both sides of Re_c, convergence of order 2 in y
// and t, uniform flow stays, mean rate, momentum and energy balance, leaving a falling branch at an
// imposed rate.
#pragma once
#include "engine/constitution.h"

#include <span>
#include <vector>

namespace sigmaflow {

enum class GapEnds { imposed_stress, imposed_rate, periodic };

struct GapFlow {
    GapEnds ends = GapEnds::imposed_stress;
    double reynolds = 0;                     // Re
    double time = 0;                         // over 1/rate of the base state
    std::vector<double> rate, stress;        // of each volume
    std::vector<std::vector<double>> parts;  // s_i of each volume
};

/// Uniform flow in the base state plus amplitude times the mode m >= 1 in the rate; the
/// microstructure is that of the base state. Errors: input (fewer than 4 cells, Re <= 0).
GapFlow disturbed_flow(const Constitution& constitution, GapEnds ends, double reynolds, int cells,
                       int mode, double amplitude);

/// The flow `time` later. Errors: numerics (no convergence in steps 1000 times smaller).
GapFlow advanced(const Constitution& constitution, const GapFlow& flow, double time);

/// Velocities at the faces, from 0 at y = 0 [rate H].
std::vector<double> velocities(const GapFlow& flow);

/// The amplitude of a mode in the deviation of a field, rate or stress, from the base state: 2
/// <(field - 1) mode>.
double mode_amplitude(const GapFlow& flow, std::span<const double> field, int mode);

}
