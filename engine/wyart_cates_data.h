// engine/wyart_cates_data.h -- what the model of wyart_cates.h is fitted to, and where it is looked
// for.
#pragma once
#include "engine/wyart_cates.h"

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace sigmaflow {

struct WyartCatesPoint {
    double volume_fraction = 0;  // [-], in (0, 1)
    double stress = 0;           // [sigma0], > 0
    double viscosity = 0;        // [eta0], > 0; of a jammed point: a lower bound
    double relative_error = 0;   // standard error of the viscosity over it [-], >= 0
    bool jammed = false;
};

/// The highest viscosity of the flowing points; 0 without any.
double lower_bound(std::span<const WyartCatesPoint> points);

/// What is held; the rest is free.
struct WyartCatesVariant {
    std::optional<double> exponent = 2;   // empty: free
    std::optional<double> sharpness = 1;  // empty: free
};

enum class WyartCatesParameter {
    onset_stress,
    frictional_fraction,
    frictionless_fraction,
    amplitude,
    exponent,
    sharpness
};
inline constexpr std::array wyart_cates_parameters{WyartCatesParameter::onset_stress,
                                                   WyartCatesParameter::frictional_fraction,
                                                   WyartCatesParameter::frictionless_fraction,
                                                   WyartCatesParameter::amplitude,
                                                   WyartCatesParameter::exponent,
                                                   WyartCatesParameter::sharpness};

std::string_view parameter_name(WyartCatesParameter parameter);
double value_of(const WyartCates& model, WyartCatesParameter parameter);
bool is_free(const WyartCatesVariant& variant, WyartCatesParameter parameter);

struct Limits {
    double lower = 0, upper = 0;
};

/// Where the fit looks: onset_stress within a factor 1e4 of the stresses, phi_mu in (0, phi_0),
/// phi_0 from the highest flowing volume fraction to 1, amplitude in [1e-6, 1e6], exponent in
/// [0.5, 10], sharpness in [0.1, 10].
Limits parameter_limits(std::span<const WyartCatesPoint> points, WyartCatesParameter parameter);

/// Why these points cannot be fitted; empty if they can: more flowing points than parameters, at
/// two volume fractions and two stresses or more.
std::string reason_not_to_fit(std::span<const WyartCatesPoint> points,
                              const WyartCatesVariant& variant);

/// Errors: input (a value out of range, reason_not_to_fit).
void check_points(std::span<const WyartCatesPoint> points, const WyartCatesVariant& variant);

}
