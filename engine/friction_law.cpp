#include "engine/friction_law.h"

#include "engine/error.h"

#include <unsupported/Eigen/LevenbergMarquardt>

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
using Parameters = Eigen::VectorXd;

double fraction_of(const Parameters& p, double stress)
{
    return std::exp(p[1] - std::exp(p[0]) / stress);
}

/// For Eigen's unsupported Levenberg-Marquardt.
struct Residuals : Eigen::DenseFunctor<double> {
    explicit Residuals(std::span<const FrictionPoint> list)
        : Eigen::DenseFunctor<double>(2, static_cast<int>(list.size())), points(list)
    {
    }

    int operator()(const Eigen::VectorXd& p, Eigen::VectorXd& residual) const
    {
        for (int k = 0; k < values(); ++k) {
            const FrictionPoint& point = points[static_cast<std::size_t>(k)];
            residual[k] = (fraction_of(p, point.stress) - point.fraction) / point.standard_error;
        }
        return 0;
    }
    int df(const Eigen::VectorXd& p, Eigen::MatrixXd& slope) const
    {
        for (int k = 0; k < values(); ++k) {
            const FrictionPoint& point = points[static_cast<std::size_t>(k)];
            const double relative = fraction_of(p, point.stress) / point.standard_error;
            slope(k, 0) = -relative * std::exp(p[0]) / point.stress;
            slope(k, 1) = relative;
        }
        return 0;
    }

    std::span<const FrictionPoint> points;
};

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
    return Eigen::Vector2d(std::log(std::max(line[1], 1e-6)), line[0]);
}

}

double FrictionLaw::fraction(double stress) const
{
    return share.mean * std::exp(-onset_stress.mean / stress);
}

FrictionLaw fit_friction_law(std::span<const FrictionPoint> points)
{
    check(points);
    Residuals residuals(points);
    Eigen::LevenbergMarquardt<Residuals> method(residuals);
    method.setFtol(1e-15);
    method.setXtol(1e-10);
    Eigen::VectorXd p = start(points);
    method.minimize(p);
    Eigen::VectorXd residual(residuals.values());
    Eigen::MatrixXd slope(residuals.values(), 2);
    residuals(p, residual);
    residuals.df(p, slope);
    const Eigen::Matrix2d covariance = (slope.transpose() * slope).inverse();
    if (!p.allFinite() || !covariance.allFinite())
        throw Error(ErrorKind::numerics, "friction law", "the fit does not converge");
    const auto value = [&](int i) {
        return Value{std::exp(p[i]), std::exp(p[i]) * std::sqrt(covariance(i, i))};
    };
    FrictionLaw law{.onset_stress = value(0), .share = value(1)};
    if (points.size() > 2)
        law.chi2_per_degree = residual.squaredNorm() / static_cast<double>(points.size() - 2);
    return law;
}

}
