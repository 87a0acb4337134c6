#include "engine/fluctuations.h"

#include "engine/error.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace sigmaflow {

Fluctuations fluctuations(std::span<const double> series)
{
    Fluctuations result;
    result.mean = estimate_mean(series);
    std::vector<double> squares;
    double third = 0, fourth = 0;
    for (double x : series) {
        const double d = x - result.mean.mean;
        squares.push_back(d * d);
        third += d * d * d / static_cast<double>(series.size());
        fourth += d * d * d * d / static_cast<double>(series.size());
    }
    const Estimate square = estimate_mean(squares);
    const double unbiased = 1 - 1 / std::max(result.mean.effective_samples, 2.);
    result.variance = square.mean / unbiased;
    result.variance_error = square.standard_error / unbiased;
    if (square.mean > 0) {
        const double samples = std::max(square.effective_samples, 1.);
        result.skewness = third / std::pow(square.mean, 1.5);
        result.skewness_error = std::sqrt(6 / samples);
        result.kurtosis = fourth / (square.mean * square.mean) - 3;
        result.kurtosis_error = std::sqrt(24 / samples);
    }
    return result;
}

PowerLaw fit_power_law(std::span<const double> x, std::span<const double> y,
                       std::span<const double> y_error)
{
    const auto positive = [](double value) { return value > 0 && std::isfinite(value); };
    if (x.size() != y.size() || x.size() != y_error.size() ||
        !std::all_of(x.begin(), x.end(), positive) || !std::all_of(y.begin(), y.end(), positive) ||
        !std::all_of(y_error.begin(), y_error.end(), positive))
        throw Error(ErrorKind::input, "power law", "needs positive numbers and errors");
    double weights = 0, mean_x = 0, mean_y = 0;
    const auto weight = [&](std::size_t k) { return std::pow(y[k] / y_error[k], 2); };
    for (std::size_t k = 0; k < x.size(); ++k) {
        weights += weight(k);
        mean_x += weight(k) * std::log(x[k]);
        mean_y += weight(k) * std::log(y[k]);
    }
    mean_x /= weights;
    mean_y /= weights;
    double xx = 0, xy = 0, chi2 = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        const double d = std::log(x[k]) - mean_x;
        xx += weight(k) * d * d;
        xy += weight(k) * d * (std::log(y[k]) - mean_y);
    }
    if (!(xx > 0)) throw Error(ErrorKind::input, "power law", "needs two different x");
    PowerLaw law{.exponent = xy / xx, .exponent_error = 1 / std::sqrt(xx)};
    law.amplitude = std::exp(mean_y - law.exponent * mean_x);
    for (std::size_t k = 0; k < x.size(); ++k) {
        const double d = std::log(y[k] / law.amplitude) - law.exponent * std::log(x[k]);
        chi2 += weight(k) * d * d;
    }
    if (x.size() > 2) law.chi2_per_degree = chi2 / static_cast<double>(x.size() - 2);
    return law;
}

}
