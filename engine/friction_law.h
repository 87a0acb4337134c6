// engine/friction_law.h -- how the share of frictional pairs rises with the stress.
//
//   f(stress) = exp(-onset_stress/stress)
//
// (Wyart & Cates, Phys. Rev. Lett. 112, 098302, 2014, with the form of Mari, Seto, Morris & Denn,
// J. Rheol. 58, 1693, 2014), times the share f_infinity that is reached at high stress: of close
// pairs not all touch. Weighted least squares by Levenberg-Marquardt in the logarithms of both
// parameters.
//
// Tests: exact points, the scatter of fits to noisy points against the errors.
#pragma once
#include "engine/value.h"

#include <span>

namespace sigmaflow {

struct FrictionPoint {
    double stress = 0;          // [sigma0] > 0
    double fraction = 0;        // [0, 1]
    double standard_error = 0;  // > 0
};

struct FrictionLaw {
    Value onset_stress;          // [sigma0]
    Value share;                 // f_infinity [-]
    double chi2_per_degree = 0;  // 0 for two points

    double fraction(double stress) const;
};

/// At least two different stresses, two fractions > 0. Errors: input; numerics (no convergence).
FrictionLaw fit_friction_law(std::span<const FrictionPoint> points);

}
