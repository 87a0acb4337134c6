#include "engine/stability.h"

#include "engine/error.h"

#include <cmath>
#include <numbers>
#include <string>

namespace sigmaflow {

namespace {

void require(bool good, const std::string& problem)
{
    if (!good) throw Error(ErrorKind::input, "stability", problem);
}

void check(const UniformFlow& flow)
{
    require(flow.viscosity.mean > 0 && std::isfinite(flow.viscosity.mean),
            "viscosity must be > 0 [eta0], got " + std::to_string(flow.viscosity.mean));
    require(flow.relaxation.mean > 0 && std::isfinite(flow.relaxation.mean),
            "relaxation must be > 0, got " + std::to_string(flow.relaxation.mean));
    require(std::isfinite(flow.slope.mean), "slope must be finite");
}

double relative_error(const Value& value)
{
    return value.standard_error / value.mean;
}

}

std::optional<Onset> onset_of_instability(const UniformFlow& flow)
{
    check(flow);
    if (flow.slope.mean >= 0) return std::nullopt;
    const double c = flow.relaxation.mean;
    const double critical =
        -std::numbers::pi * std::numbers::pi / (c * flow.viscosity.mean * flow.slope.mean);
    const double error = std::hypot(relative_error(flow.viscosity), relative_error(flow.slope),
                                    relative_error(flow.relaxation));
    return Onset{.reynolds = {critical, critical * error},
                 .frequency = std::numbers::pi * std::sqrt(c / critical)};
}

std::array<std::complex<double>, 2> growth_rates(const UniformFlow& flow, double reynolds, int mode)
{
    check(flow);
    require(reynolds > 0 && std::isfinite(reynolds), "Re must be > 0");
    require(mode >= 1, "mode must be >= 1");
    const double damping = std::pow(mode * std::numbers::pi, 2) / reynolds;
    const double c = flow.relaxation.mean;
    const double half = (damping + c * flow.viscosity.mean * flow.slope.mean) / 2;
    const double product = c * damping;
    if (half * half < product) {
        const double imaginary = std::sqrt(product - half * half);
        return {std::complex(-half, imaginary), std::complex(-half, -imaginary)};
    }
    // the root of larger size has no cancellation, the other one follows from the product
    const double large = -half - std::copysign(std::sqrt(half * half - product), half);
    const double small = product / large;
    return {std::max(large, small), std::min(large, small)};
}

}
