#include "engine/wyart_cates.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace sigmaflow {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double scaled_stress(const WyartCates& model, double stress)
{
    return std::pow(model.onset_stress / stress, model.sharpness);
}

/// g of the header: d(1/phi_J)/d ln stress.
double fall_of_jamming(const WyartCates& model, double stress)
{
    const double jamming = jamming_fraction(model, stress);
    return (model.frictionless_fraction - model.frictional_fraction) *
           frictional_share(model, stress) * model.sharpness * scaled_stress(model, stress) /
           (jamming * jamming);
}

}

double frictional_share(const WyartCates& model, double stress)
{
    return std::exp(-scaled_stress(model, stress));
}

double jamming_fraction(const WyartCates& model, double stress)
{
    const double f = frictional_share(model, stress);
    return f * model.frictional_fraction + (1 - f) * model.frictionless_fraction;
}

double viscosity(const WyartCates& model, double volume_fraction, double stress)
{
    const double distance = 1 - volume_fraction / jamming_fraction(model, stress);
    return distance > 0 ? model.amplitude * std::pow(distance, -model.exponent) : infinity;
}

double shear_rate(const WyartCates& model, double volume_fraction, double stress)
{
    return stress / viscosity(model, volume_fraction, stress);
}

double thickening_slope(const WyartCates& model, double volume_fraction, double stress)
{
    const double distance = 1 - volume_fraction / jamming_fraction(model, stress);
    return distance > 0
               ? model.exponent * volume_fraction * fall_of_jamming(model, stress) / distance
               : infinity;
}

double falling_fraction(const WyartCates& model, double stress)
{
    return 1 /
           (model.exponent * fall_of_jamming(model, stress) + 1 / jamming_fraction(model, stress));
}

std::optional<CriticalPoint> critical_point(const WyartCates& model)
{
    const auto fraction = [&](double log_stress) {
        return falling_fraction(model, std::exp(log_stress));
    };
    constexpr int intervals = 400;
    const double first = std::log(model.onset_stress * 1e-3);
    const double spacing = std::log(1e6) / intervals;
    int best = 0;
    for (int k = 1; k <= intervals; ++k)
        if (fraction(first + k * spacing) < fraction(first + best * spacing)) best = k;
    if (best == 0 || best == intervals) return {};
    double low = first + (best - 1) * spacing, high = first + (best + 1) * spacing;
    constexpr double section = 1 / std::numbers::phi;
    while (high - low > 1e-9) {
        const double left = high - section * (high - low), right = low + section * (high - low);
        if (fraction(left) < fraction(right))
            high = right;
        else
            low = left;
    }
    const double stress = std::exp((low + high) / 2);
    const double volume_fraction = falling_fraction(model, stress);
    return CriticalPoint{volume_fraction, stress, shear_rate(model, volume_fraction, stress)};
}

double largest_stress(const WyartCates& model, double volume_fraction)
{
    if (volume_fraction <= model.frictional_fraction) return infinity;
    if (volume_fraction >= model.frictionless_fraction) return 0;
    const double f = (model.frictionless_fraction - volume_fraction) /
                     (model.frictionless_fraction - model.frictional_fraction);
    return model.onset_stress * std::pow(-std::log(f), -1 / model.sharpness);
}

CurveShape model_shape(const WyartCates& model, double volume_fraction)
{
    if (volume_fraction > model.frictional_fraction) return CurveShape::arch;
    const std::optional<CriticalPoint> critical = critical_point(model);
    return critical && volume_fraction > critical->volume_fraction ? CurveShape::s_shaped
                                                                   : CurveShape::continuous;
}

}
