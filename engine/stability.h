// engine/stability.h -- is uniform flow stable where the shear rate falls with the stress?
//
// Momentum and a microstructure that remembers the stress over some strain (Mari, Seto, Morris &
// Denn, Phys. Rev. E 91, 052302, 2015, section IV). In the steady state stress = eta rate. Their
// Eqs. (deltaf_eq, stress_evo) with the kernel of engine/memory_kernel.h, M(x) = w_0 + sum_i w_i
// c_i/(x + c_i) its Laplace transform over the strain, read for a disturbance exp(s t + i k y)
//
//   d_stress = eta d_rate + g M(s/rate) d_stress,  g = rate d eta/d stress = 1 - eta slope,
//   rho s d_rate = -k^2 d_stress,                   slope = d rate/d stress.
//
// In a gap H, k = m pi/H. With Re = rho rate H^2/eta, x = s/rate, D = m^2 pi^2/Re, b = eta slope:
//
//   F(x) = x + D - g x M(x) = D + x C(x) = 0,   C(x) = b + sum_i B_i x/(x + c_i),   B_i = g w_i.
//
// C/eta is the answer of the rate to a stress exp(x strain): C(0) = b that to a slow change,
// C(infinity) = h = 1 - g w_0 = eta/eta_instantaneous that to a sudden one, which must be > 0. A
// measured instantaneous viscosity sets h, and then B_i = (h - b) w_i/sum w.
//
// Roots: F prod (x + c_i) is a polynomial of degree terms + 1. Onset: on the imaginary axis,
// x = i omega, Re C = 0 gives omega whatever Re is, and D = omega Im C:
//
//   -b = sum_i B_i omega^2/(omega^2 + c_i^2),   D = sum_i B_i c_i omega^2/(omega^2 + c_i^2);
//
// the flow is stable below Re_c = pi^2/D of the largest such D, where a pair of roots crosses the
// axis (a Hopf bifurcation), and begins to oscillate with omega. So Re_c = -pi^2/(c eta slope) with
// c the mean of the c_i with the weights B_i/(omega^2 + c_i^2): slow parts of the memory count
// most. For B_i >= 0 there is one onset if b < 0 and none if b >= 0, because Re C then lies between
// b and h. With one exponential and w_0 = 0 all this is the paper's: x^2 + x (D + c b) + c D = 0.
//
// At an imposed mean rate there is also k = 0, D = 0: C(x) = 0 has a positive root if b < 0, -b c/h
// for one exponential. Uniform flow then leaves the falling branch whatever Re is; the onset above
// holds for an imposed stress.
//
// Tests: roots against the matrix of the linear system and the argument principle, onset against
// bisection of the growth rate, growth in time of the differential equations, the paper's formulas.
#pragma once
#include "engine/memory_kernel.h"
#include "engine/value.h"

#include <array>
#include <cmath>
#include <complex>
#include <optional>
#include <vector>

namespace sigmaflow {

/// A steady state and the memory of its microstructure: one exponential.
struct UniformFlow {
    Value viscosity;   // stress over rate [eta0], > 0
    Value slope;       // d rate/d stress along the flow curve [1/eta0]
    Value relaxation;  // c, one over the relaxation strain [-], > 0
};

struct Onset {
    Value reynolds;        // Re_c [-]
    double frequency = 0;  // angular, over the shear rate [-]
};

/// Nothing if the slope is >= 0: stable at all Re. Relative errors of the three factors add in
/// squares. Errors: input (a value out of range).
std::optional<Onset> onset_of_instability(const UniformFlow& flow);

/// The two roots s over the shear rate for the mode m >= 1 at Re > 0, that with the larger real
/// part first. Errors: input.
std::array<std::complex<double>, 2> growth_rates(const UniformFlow& flow, double reynolds,
                                                 int mode = 1);

/// A steady state with any memory.
struct MemoryFlow {
    Value viscosity;  // > 0 [eta0]
    Value slope;      // [1/eta0]
    MemoryKernel kernel;
    /// eta_instantaneous [eta0] > 0; if given, the weights of the kernel are relative ones.
    std::optional<double> instantaneous_viscosity = {};
};

/// That of the kernel if none is given [eta0]. Errors: input (not positive: no such suspension).
double instantaneous_viscosity(const MemoryFlow& flow);

/// F(x). Errors: input.
std::complex<double> dispersion(const MemoryFlow& flow, double reynolds, int mode,
                                std::complex<double> x);

/// The roots x by falling real part. Errors: input.
std::vector<std::complex<double>> growth_rates(const MemoryFlow& flow, double reynolds,
                                               int mode = 1);

/// How many of them have a positive real part.
int growing_roots(const MemoryFlow& flow, double reynolds, int mode = 1);

/// The largest real part of the zeros of C: the growth of a disturbance of uniform flow as a whole
/// when its rate is imposed; negative: stable. Errors: input.
double growth_at_imposed_rate(const MemoryFlow& flow);

/// The number of roots with a positive real part by the argument principle, independent of the
/// polynomial. Errors: input; numerics (a root on the imaginary axis).
int unstable_roots(const MemoryFlow& flow, double reynolds, int mode = 1);

/// Nothing: stable at all Re. The error follows from those of viscosity, slope and every weight
/// (the sum and w_0 kept) and c, as if independent (central differences). Errors: input.
std::optional<Onset> onset_of_instability(const MemoryFlow& flow);

/// The smallest Re at which the first mode grows with exp(growth strain), growth >= 0, by
/// bisection; nothing if no Re is large enough. Errors: input.
std::optional<double> reynolds_of_growth(const MemoryFlow& flow, double growth);

/// Re = rho rate H^2/eta of a gap H [sqrt(eta0/(rho rate0))], and the gap of a Reynolds number.
inline double reynolds_number(double shear_rate, double viscosity, double gap)
{
    return shear_rate * gap * gap / viscosity;
}
inline double gap_of(double reynolds, double shear_rate, double viscosity)
{
    return std::sqrt(reynolds * viscosity / shear_rate);
}

}
