#include "engine/wyart_cates_variables.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace sigmaflow {

namespace {

using Eigen::VectorXd;
using Parameter = WyartCatesParameter;

double squeezed(double x, double from, double to)
{
    return from + (to - from) / (1 + std::exp(-x));
}

double stretched(double value, double from, double to)
{
    constexpr double edge = 1e-9;
    const double share = std::clamp((value - from) / (to - from), edge, 1 - edge);
    return std::log(share / (1 - share));
}

double squeezed(double x, const Limits& positive)
{
    return std::exp(squeezed(x, std::log(positive.lower), std::log(positive.upper)));
}

double stretched(double value, const Limits& positive)
{
    return stretched(std::log(value), std::log(positive.lower), std::log(positive.upper));
}

}

WyartCatesVariables::WyartCatesVariables(std::span<const WyartCatesPoint> points,
                                         const WyartCatesVariant& variant)
    : variant_(variant)
{
    std::map<double, double> densest;  // others at the same stress are then below phi_J, too
    for (const WyartCatesPoint& p : points) {
        if (p.jammed) continue;
        double& highest = densest[p.stress];
        highest = std::max(highest, p.volume_fraction);
    }
    for (const auto& [stress, volume_fraction] : densest)
        densest_.push_back({stress, volume_fraction});
    for (std::size_t k = 0; k < limits_.size(); ++k)
        limits_[k] = parameter_limits(points, wyart_cates_parameters[k]);
}

WyartCates WyartCatesVariables::held() const
{
    return {.exponent = variant_.exponent.value_or(2), .sharpness = variant_.sharpness.value_or(1)};
}

double WyartCatesVariables::lowest_frictional_fraction(const WyartCates& model) const
{
    double lowest = limit(Parameter::frictional_fraction).lower;
    for (const Flowing& p : densest_) {
        const double f = frictional_share(model, p.stress);
        if (f > 0)
            lowest =
                std::max(lowest, (p.volume_fraction - (1 - f) * model.frictionless_fraction) / f);
    }
    return lowest;
}

WyartCates WyartCatesVariables::model(const VectorXd& x) const
{
    WyartCates m = held();
    Eigen::Index next = 4;
    if (!variant_.exponent) m.exponent = squeezed(x[next++], limit(Parameter::exponent));
    if (!variant_.sharpness) m.sharpness = squeezed(x[next++], limit(Parameter::sharpness));
    m.onset_stress = squeezed(x[0], limit(Parameter::onset_stress));
    m.amplitude = squeezed(x[1], limit(Parameter::amplitude));
    const Limits& frictionless = limit(Parameter::frictionless_fraction);
    m.frictionless_fraction = squeezed(x[2], frictionless.lower, frictionless.upper);
    m.frictional_fraction = squeezed(x[3], lowest_frictional_fraction(m), m.frictionless_fraction);
    return m;
}

VectorXd WyartCatesVariables::variables_of(const WyartCates& m) const
{
    VectorXd x(size());
    Eigen::Index next = 4;
    if (!variant_.exponent) x[next++] = stretched(m.exponent, limit(Parameter::exponent));
    if (!variant_.sharpness) x[next++] = stretched(m.sharpness, limit(Parameter::sharpness));
    x[0] = stretched(m.onset_stress, limit(Parameter::onset_stress));
    x[1] = stretched(m.amplitude, limit(Parameter::amplitude));
    const Limits& frictionless = limit(Parameter::frictionless_fraction);
    x[2] = stretched(m.frictionless_fraction, frictionless.lower, frictionless.upper);
    x[3] = stretched(m.frictional_fraction, lowest_frictional_fraction(m), m.frictionless_fraction);
    return x;
}

}
