#include "engine/friction_law.h"

#include "engine/error.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace sigmaflow {

namespace {

void check(std::span<const FrictionPoint> points)
{
    const auto wrong = [](const FrictionPoint& p) {
        return !(p.stress > 0 && p.fraction >= 0 && p.fraction <= 1 && p.standard_error > 0);
    };
    const auto positive = [](const FrictionPoint& p) { return p.fraction > 0; };
    if (std::any_of(points.begin(), points.end(), wrong) ||
        std::count_if(points.begin(), points.end(), positive) < 2)
        throw Error(ErrorKind::input, "friction law",
                    "needs two fractions > 0, stresses and errors > 0");
    const auto [low, high] = std::minmax_element(
        points.begin(), points.end(),
        [](const FrictionPoint& a, const FrictionPoint& b) { return a.stress < b.stress; });
    if (low->stress == high->stress)
        throw Error(ErrorKind::input, "friction law", "needs two different stresses");
}

/// ln onset stress, ln share
using Parameters = Eigen::Vector2d;

double fraction_of(const Parameters& p, double stress)
{
    return std::exp(p[1] - std::exp(p[0]) / stress);
}

struct Linearised {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Parameters gradient = Parameters::Zero();
    double chi2 = 0;
};

Linearised linearised(const Parameters& p, std::span<const FrictionPoint> points)
{
    Linearised result;
    for (const FrictionPoint& point : points) {
        const double f = fraction_of(p, point.stress);
        const double residual = (point.fraction - f) / point.standard_error;
        const Parameters slope(-f * std::exp(p[0]) / point.stress, f);
        const Parameters row = slope / point.standard_error;
        result.normal += row * row.transpose();
        result.gradient += row * residual;
        result.chi2 += residual * residual;
    }
    return result;
}

/// A straight line through ln f over 1/stress, with the weights of ln f.
Parameters start(std::span<const FrictionPoint> points)
{
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for (const FrictionPoint& p : points) {
        if (!(p.fraction > 0)) continue;
        const double weight = p.fraction / p.standard_error;
        const Eigen::Vector2d row = weight * Eigen::Vector2d(1, -1 / p.stress);
        normal += row * row.transpose();
        right += row * weight * std::log(p.fraction);
    }
    const Eigen::Vector2d line = normal.ldlt().solve(right);
    return {std::log(std::max(line[1], 1e-6)), line[0]};
}

}

double FrictionLaw::fraction(double stress) const
{
    return share.mean * std::exp(-onset_stress.mean / stress);
}

FrictionLaw fit_friction_law(std::span<const FrictionPoint> points)
{
    check(points);
    Parameters p = start(points);
    Linearised now = linearised(p, points);
    double damping = 1e-3;
    constexpr int most_iterations = 500;
    for (int k = 0; k < most_iterations; ++k) {
        Eigen::Matrix2d damped = now.normal;
        damped.diagonal() *= 1 + damping;
        const Parameters step = damped.ldlt().solve(now.gradient);
        const Linearised next = linearised(p + step, points);
        if (next.chi2 <= now.chi2) {
            p += step;
            now = next;
            damping = std::max(damping / 10, 1e-12);
            if (step.norm() < 1e-10) break;
        } else {
            damping *= 10;
            if (damping > 1e12) break;  // nothing smaller nearby
        }
    }
    const Eigen::Matrix2d covariance = now.normal.inverse();
    if (!p.allFinite() || !covariance.allFinite())
        throw Error(ErrorKind::numerics, "friction law", "the fit does not converge");
    const auto value = [&](int i) {
        return Value{std::exp(p[i]), std::exp(p[i]) * std::sqrt(covariance(i, i))};
    };
    FrictionLaw law{.onset_stress = value(0), .share = value(1)};
    if (points.size() > 2) law.chi2_per_degree = now.chi2 / static_cast<double>(points.size() - 2);
    return law;
}

}
