// engine/wyart_cates_fit.h -- the model of wyart_cates.h from measured viscosities.
//
// The logarithm of a viscosity is taken as normal about that of the model, with the variance
//   s^2 = relative_error^2 + scatter^2,
// where scatter stands for what the model cannot describe. It is a parameter like the others:
// without it, the points with the smallest errors would decide everything, however wrong the model
// is. All are found by maximum likelihood (deviance = -2 ln likelihood):
//   flowing  contributes (ln viscosity - ln model)^2/s^2 + ln(2 pi s^2)
//   jammed   contributes -2 ln Phi(z), z = (ln model - ln viscosity)/scatter,
// Phi the normal distribution: a jammed point says only that the viscosity is higher than a bound
// (it is censored: J. Tobin, Econometrica 26, 24, 1958), pulls the less the higher the model lies
// above it, and not at all where the model is jammed. Why a bound on the viscosity, and not
// phi >= phi_J: finite systems jam by chance below the jamming fraction of large ones, and the
// bound needs no scale for a distance in volume fractions. lower_bound() is the highest viscosity
// that flowed: what jams is known to be above that, and no more.
//
// For a given scatter this is a sum of squares, which Levenberg and Marquardt minimise (Eigen) in
// variables that keep phi < phi_J at all flowing points and all parameters within their limits; the
// scatter is then improved, and so on until nothing changes.
//
// Tests: a published table with the fits of an independent program, recovery of known parameters,
// direction of the pull of jammed points.
#pragma once
#include "engine/wyart_cates_data.h"

namespace sigmaflow {

struct WyartCatesFit {
    WyartCates model;
    double scatter = 0;   // of ln viscosity [-], at least 1e-6
    double rms = 0;       // of ln viscosity - ln model over the flowing points [-]
    double deviance = 0;  // -2 ln likelihood
    double akaike = 0;    // deviance + 2 (parameters + 1), the 1 for the scatter
    int parameters = 0, flowing = 0, jammed = 0;
    bool converged = false;
};

/// From many starting points. Errors: input (a value out of range, reason_not_to_fit).
WyartCatesFit fit_wyart_cates(std::span<const WyartCatesPoint> points,
                              const WyartCatesVariant& variant = {});

struct HeldParameter {
    WyartCatesParameter parameter;
    double value;
};

/// From one starting point, e.g. the fit of similar data; where it has phi >= phi_J at a flowing
/// point it is moved. With `held`, that parameter is kept at that value (to 1e-6 of it) and does
/// not count. Errors: input.
WyartCatesFit refit_wyart_cates(std::span<const WyartCatesPoint> points,
                                const WyartCatesVariant& variant, const WyartCatesFit& start,
                                const std::optional<HeldParameter>& held = {});

}
