// engine/fluctuations.h -- how much a stationary series fluctuates, and how that depends on the
// size of the system.
//
// The variance is the mean of (x - mean)^2; its standard error is that of this mean for correlated
// samples (engine/statistics.h). Skewness and excess kurtosis are 0 for normal fluctuations;
// intermittency (rare large excursions) makes the kurtosis large. Their standard errors are those
// of normal samples, roots of 6/N and 24/N, with the effective number N of squares. The missing
// factor 1 - 2 tau/n of the variance (its bias from the mean being that of the same series) is
// divided out. Independent parts of a large system give a variance proportional to 1/n (Mari, Seto,
// Morris & Denn, Phys. Rev. E 91, 052302, 2015, Fig. 4).
#pragma once
#include "engine/statistics.h"

#include <span>

namespace sigmaflow {

struct Fluctuations {
    Estimate mean;
    double variance = 0, variance_error = 0;
    double skewness = 0, skewness_error = 0;  // third moment over variance^(3/2) [-]
    double kurtosis = 0, kurtosis_error = 0;  // fourth over variance^2, minus 3 [-]
};

/// Errors: numerics (a sample that is not finite).
Fluctuations fluctuations(std::span<const double> series);

/// y = amplitude x^exponent.
struct PowerLaw {
    double exponent = 0, exponent_error = 0;
    double amplitude = 0;
    double chi2_per_degree = 0;  // 0 for two points
};

/// Least squares of ln y, weighted by the relative errors; all x, y and errors > 0, at least two
/// different x. Errors: input.
PowerLaw fit_power_law(std::span<const double> x, std::span<const double> y,
                       std::span<const double> y_error);

}
