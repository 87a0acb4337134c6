#include "engine/wyart_cates_data.h"

#include "engine/error.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace sigmaflow {

namespace {

constexpr std::array<std::string_view, wyart_cates_parameters.size()> names{
    "onset_stress", "frictional_fraction", "frictionless_fraction", "amplitude", "exponent",
    "sharpness"};

void require(bool good, const std::string& problem)
{
    if (!good) throw Error(ErrorKind::input, "fit of the Wyart-Cates model", problem);
}

bool positive(double value)
{
    return value > 0 && std::isfinite(value);
}

}

double lower_bound(std::span<const WyartCatesPoint> points)
{
    double highest = 0;
    for (const WyartCatesPoint& p : points)
        if (!p.jammed) highest = std::max(highest, p.viscosity);
    return highest;
}

std::string_view parameter_name(WyartCatesParameter parameter)
{
    return names[static_cast<std::size_t>(parameter)];
}

double value_of(const WyartCates& model, WyartCatesParameter parameter)
{
    const std::array values{model.onset_stress,
                            model.frictional_fraction,
                            model.frictionless_fraction,
                            model.amplitude,
                            model.exponent,
                            model.sharpness};
    return values[static_cast<std::size_t>(parameter)];
}

bool is_free(const WyartCatesVariant& variant, WyartCatesParameter parameter)
{
    if (parameter == WyartCatesParameter::exponent) return !variant.exponent;
    if (parameter == WyartCatesParameter::sharpness) return !variant.sharpness;
    return true;
}

Limits parameter_limits(std::span<const WyartCatesPoint> points, WyartCatesParameter parameter)
{
    double densest = 0, lowest = HUGE_VAL, highest = 0;
    for (const WyartCatesPoint& p : points) {
        lowest = std::min(lowest, p.stress);
        highest = std::max(highest, p.stress);
        if (!p.jammed) densest = std::max(densest, p.volume_fraction);
    }
    switch (parameter) {
        case WyartCatesParameter::onset_stress:
            return {lowest * 1e-4, highest * 1e4};
        case WyartCatesParameter::frictional_fraction:
            return {1e-3, 1};
        case WyartCatesParameter::frictionless_fraction:
            return {densest, 1};
        case WyartCatesParameter::amplitude:
            return {1e-6, 1e6};
        case WyartCatesParameter::exponent:
            return {0.5, 10};
        case WyartCatesParameter::sharpness:
            break;
    }
    return {0.1, 10};
}

std::string reason_not_to_fit(std::span<const WyartCatesPoint> points,
                              const WyartCatesVariant& variant)
{
    std::set<double> fractions, stresses;
    long flowing = 0;
    for (const WyartCatesPoint& p : points) {
        if (p.jammed) continue;
        ++flowing;
        fractions.insert(p.volume_fraction);
        stresses.insert(p.stress);
    }
    const auto free = std::count_if(wyart_cates_parameters.begin(), wyart_cates_parameters.end(),
                                    [&](WyartCatesParameter p) { return is_free(variant, p); });
    if (flowing <= free)
        return std::to_string(free) + " parameters need at least " + std::to_string(free + 1) +
               " flowing points, there are " + std::to_string(flowing);
    if (fractions.size() < 2) return "needs flowing points at two volume fractions or more";
    if (stresses.size() < 2) return "needs flowing points at two stresses or more";
    return "";
}

void check_points(std::span<const WyartCatesPoint> points, const WyartCatesVariant& variant)
{
    for (const WyartCatesPoint& p : points) {
        require(
            p.volume_fraction > 0 && p.volume_fraction < 1,
            "a volume fraction must lie between 0 and 1, got " + std::to_string(p.volume_fraction));
        require(positive(p.stress), "a stress must be > 0, got " + std::to_string(p.stress));
        require(positive(p.viscosity),
                "a viscosity must be > 0, got " + std::to_string(p.viscosity));
        require(p.relative_error >= 0 && std::isfinite(p.relative_error),
                "a relative error must be >= 0, got " + std::to_string(p.relative_error));
    }
    const auto held_in = [](const std::optional<double>& value, double low, double high,
                            const char* name) {
        require(!value || (*value >= low && *value <= high),
                std::string(name) + " must lie between " + std::to_string(low) + " and " +
                    std::to_string(high));
    };
    const Limits n = parameter_limits(points, WyartCatesParameter::exponent);
    const Limits beta = parameter_limits(points, WyartCatesParameter::sharpness);
    held_in(variant.exponent, n.lower, n.upper, "the exponent");
    held_in(variant.sharpness, beta.lower, beta.upper, "the sharpness");
    const std::string reason = reason_not_to_fit(points, variant);
    require(reason.empty(), reason);
}

}
