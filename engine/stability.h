// engine/stability.h -- is uniform flow stable where the shear rate falls with the stress?
//
// Momentum and a microstructure that follows the stress with an exponential memory over the strain
// 1/c (Mari, Seto, Morris & Denn, Phys. Rev. E 91, 052302, 2015, section IV). A disturbance
// exp(s t + i k y) of the uniform flow grows with the roots s of their Eq. (roots_eq),
//
//   s^2 + s (k^2 eta/rho + c rate eta slope) + c rate k^2 eta/rho = 0,    slope = d rate/d stress.
//
// In a gap H, k = m pi/H, with the Reynolds number Re = rho rate H^2/eta and x = s/rate:
//
//   x^2 + x (m^2 pi^2/Re + c eta slope) + c m^2 pi^2/Re = 0,
//
// so that the flow is stable below Re_c = -pi^2/(c eta slope), and at all Re if the slope is not
// negative. The product of the roots is positive: at Re_c a pair crosses the imaginary axis (a Hopf
// bifurcation), and the flow begins to oscillate with the angular frequency rate pi sqrt(c/Re_c).
//
// Tests: the roots solve the equation; the growth of its two differential equations in time.
#pragma once
#include "engine/value.h"

#include <array>
#include <complex>
#include <optional>

namespace sigmaflow {

/// A steady state and the memory of its microstructure.
struct UniformFlow {
    Value viscosity;   // stress over rate [eta0], > 0
    Value slope;       // d rate/d stress along the flow curve [1/eta0]
    Value relaxation;  // c, one over the relaxation strain [-], > 0
};

struct Onset {
    Value reynolds;        // Re_c [-]; relative errors of the three factors added in squares
    double frequency = 0;  // angular, over the shear rate [-]
};

/// Nothing if the slope is >= 0: stable at all Re. Errors: input (a value out of range).
std::optional<Onset> onset_of_instability(const UniformFlow& flow);

/// The two roots s over the shear rate for the mode m >= 1 at Re > 0, that with the larger real
/// part first. Errors: input.
std::array<std::complex<double>, 2> growth_rates(const UniformFlow& flow, double reynolds,
                                                 int mode = 1);

}
