// engine/one_dimensional_flow.h -- flow across a gap with inertia and a microstructure that
// remembers the stress, integrated in time: what the linear theory of engine/stability.h leaves
// out.
//
// Momentum of unidirectional flow u(y, t), rho du/dt = d stress/dy, for the local rate
//
//   rho d rate/dt = d^2 stress/dy^2,
//
// with walls at y = 0 and H whose velocities are imposed (d stress/dy = 0 there, modes k = m pi/H),
// or periodic (k = 2 pi m/H). The mean rate stays. The stress follows from the rate and the
// microstructure by a Constitution (engine/constitution.h).
//
// Everything is over a base state: rates over its rate, stresses over its stress, y over H, times
// over 1/rate (mean strain), velocities over rate H; then rho becomes the Reynolds number Re.
// Numbers: finite volumes of equal size, rates and parts at centres, velocities at faces. Time:
// two-stage implicit Runge-Kutta method of order 2, L-stable (Alexander, SIAM J. Numer. Anal. 14,
// 1006, 1977), Newton's method for the stresses of all volumes at once. A step that does not
// converge is divided.
//
// Tests: growth and frequency against the roots on both sides of Re_c, convergence of order 2 in y
// and t, uniform flow stays, mean rate, momentum, an energy balance.
#pragma once
#include "engine/constitution.h"

#include <span>
#include <vector>

namespace sigmaflow {

enum class GapEnds { walls, periodic };

struct GapFlow {
    GapEnds ends = GapEnds::walls;
    double reynolds = 0;                     // Re
    double time = 0;                         // mean strain
    std::vector<double> rate, stress;        // of each volume
    std::vector<std::vector<double>> parts;  // s_i of each volume
};

/// Uniform flow in the base state plus amplitude cos(k y) in the rate, k of the mode m >= 1; the
/// microstructure is that of the base state. Errors: input (fewer than 4 cells, Re <= 0).
GapFlow disturbed_flow(const Constitution& constitution, GapEnds ends, double reynolds, int cells,
                       int mode, double amplitude);

/// The flow `time` later. Errors: numerics (no convergence in steps 1000 times smaller).
GapFlow advanced(const Constitution& constitution, const GapFlow& flow, double time);

/// Velocities at the faces, from 0 at y = 0 [rate H].
std::vector<double> velocities(const GapFlow& flow);

/// 2 <field cos(k y)>: the amplitude of a mode in a field of the volumes.
double mode_amplitude(const GapFlow& flow, std::span<const double> field, int mode);

}
