// engine/constitution.h -- how the stress follows from shear rate and microstructure, far from the
// steady state too.
//
// The microstructure has parts s_i, s = sum_i a_i s_i with a_i = w_i/sum w of a memory kernel, that
// relax over the local strain,
//
//   d s_i/dt = |rate| c_i (s*(stress) - s_i),
//
// and rate*(stress) is the steady flow curve. Two readings of s, both with the linear theory of
// engine/stability.h for their kernels:
//
//   viscous   s is the fluidity: stress = rate/s, s* = rate*(stress)/stress. The viscosity is a
//             function of the microstructure (Mari, Seto, Morris & Denn, Phys. Rev. E 91, 052302,
//             2015, section IV); w_0 = 0
//   contact   s is the stress that contacts carry: stress = eta_i rate + s, with the instantaneous
//             viscosity eta_i; s* = stress - eta_i rate*(stress)
//
// Everything is over a base state: rates over its rate, stresses over its stress, viscosities over
// its viscosity. The steady curve of measured points is a monotone cubic interpolation of the rate
// over ln stress (Fritsch & Butland, SIAM J. Sci. Stat. Comput. 5, 300, 1984: extremes only at
// points), with a constant viscosity below the lowest and above the highest stress, and the rate 0
// from a jammed point on.
//
// Tests: response to a step in stress against the kernel; the curve at its points, its slope.
#pragma once
#include "engine/flow_curve.h"
#include "engine/memory_kernel.h"

#include <functional>
#include <span>
#include <vector>

namespace sigmaflow {

/// A steady flow curve through measured points.
struct SteadyCurve {
    std::vector<double> logarithm, rate, derivative;  // ln stress, rate, d rate/d ln stress
    bool jams = false;                                // at the last point

    double shear_rate(double stress) const;  // stress >= 0
    double slope(double stress) const;       // d rate/d stress
    /// Where d ln rate/d ln stress is smallest between two stresses: of all states with one memory
    /// that has the smallest Re_c.
    double steepest_fall(double from, double to) const;
};

/// Up to the first jammed point; at least two points with rates > 0. Errors: input.
SteadyCurve steady_curve(std::span<const FlowPoint> points);

/// rate*(stress) over the base state, for stress >= 0; rates >= 0.
using SteadyRate = std::function<double(double)>;

/// How the stress depends on rate and microstructure s, and what s tends to.
struct Constitution {
    std::function<double(double rate, double s)> stress;
    std::function<double(double rate, double s)> stress_by_rate;  // derivative
    std::function<double(double rate, double s)> stress_by_s;
    std::function<double(double stress)> target;  // s*
    std::vector<double> shares, c;                // a_i, adding to 1, and c_i
};

/// The curve over the state at `stress`. Errors: input (no flow there).
SteadyRate over_base(const SteadyCurve& curve, double stress);

/// Errors: input (a kernel that is none, with an instantaneous part in the viscous reading).
Constitution viscous_constitution(const SteadyRate& steady, const MemoryKernel& kernel);
/// eta_i over the viscosity of the base state, > 0.
Constitution contact_constitution(const SteadyRate& steady, const MemoryKernel& kernel,
                                  double instantaneous_viscosity);

}
