// engine/wyart_cates.h -- thickening as a crossover between two jamming fractions.
//
//   f(stress)      = exp(-(onset_stress/stress)^sharpness)             share of frictional contacts
//   phi_J(stress)  = f frictional_fraction + (1 - f) frictionless_fraction       jamming fraction
//   viscosity/eta0 = amplitude (1 - phi/phi_J)^(-exponent)  for phi < phi_J, else infinite: jammed
//
// Wyart & Cates, Phys. Rev. Lett. 112, 098302 (2014): exponent 2, sharpness 1; Singh, Mari, Denn &
// Morris, J. Rheol. 62, 457 (2018) for the names sigma*, phi_J^mu and phi_J^0 of onset_stress,
// frictional_fraction and frictionless_fraction. Both names of a quantity are used below.
//
// What follows from the formulas, with g = (phi_0 - phi_mu) f sharpness (sigma*/stress)^sharpness
// / phi_J^2:
//   d ln viscosity/d ln stress = exponent phi g/(1 - phi/phi_J)
// so the shear rate falls with the stress (the logarithmic slope is above 1) between
//   phi_F(stress) = 1/(exponent g + 1/phi_J)  and  phi_J(stress),
// discontinuous thickening begins at the lowest phi_F of all stresses (the critical point of Mari,
// Seto, Morris & Denn, Phys. Rev. E 91, 052302, 2015, Fig. 1), and a suspension between phi_mu and
// phi_0 jams at the stress with phi_J(stress) = phi.
//
// Tests: numerical derivatives, bisection, and scans over stress of the formulas above.
#pragma once
#include "engine/flow_curve.h"

#include <optional>

namespace sigmaflow {

struct WyartCates {
    double onset_stress = 1;              // sigma* [sigma0], > 0
    double frictional_fraction = 0.58;    // phi_mu [-], > 0, <= phi_0
    double frictionless_fraction = 0.65;  // phi_0 [-]
    double amplitude = 1;                 // [-], > 0
    double exponent = 2;                  // [-], > 0
    double sharpness = 1;                 // beta [-], > 0
};

// For stresses > 0 [sigma0] and volume fractions >= 0; nothing is checked.
double frictional_share(const WyartCates& model, double stress);
double jamming_fraction(const WyartCates& model, double stress);

/// [eta0]; infinite where jammed.
double viscosity(const WyartCates& model, double volume_fraction, double stress);
/// [rate0]; 0 where jammed.
double shear_rate(const WyartCates& model, double volume_fraction, double stress);
/// d ln viscosity/d ln stress [-]; infinite where jammed.
double thickening_slope(const WyartCates& model, double volume_fraction, double stress);

/// phi_F: the rate falls at this stress for all volume fractions from here up to phi_J [-].
double falling_fraction(const WyartCates& model, double stress);

/// Where discontinuous thickening begins.
struct CriticalPoint {
    double volume_fraction = 0;  // phi_DST [-]
    double stress = 0;           // [sigma0]
    double shear_rate = 0;       // [rate0]
};

/// The lowest phi_F between onset_stress/1000 and 1000 onset_stress. None if phi_F decreases up to
/// the end of that range (exponent times sharpness below about 1, or phi_mu = phi_0): thickening is
/// then continuous up to phi_mu.
std::optional<CriticalPoint> critical_point(const WyartCates& model);

/// sigma_max [sigma0]: flows below, jams above; infinite up to phi_mu, 0 from phi_0 on.
double largest_stress(const WyartCates& model, double volume_fraction);

/// Continuous below phi_DST, S-shaped up to phi_mu, arch-shaped above.
CurveShape model_shape(const WyartCates& model, double volume_fraction);

}
