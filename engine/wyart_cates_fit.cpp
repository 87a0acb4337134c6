#include "engine/wyart_cates_fit.h"

#include "engine/wyart_cates_variables.h"

#include <unsupported/Eigen/LevenbergMarquardt>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace sigmaflow {

namespace {

using Eigen::VectorXd;

constexpr double smallest_scatter = 1e-6, largest_scatter = 10;

/// -2 ln Phi(z).
double censored_deviance(double z)
{
    if (z > 0) return -2 * std::log1p(-0.5 * std::erfc(z / std::numbers::sqrt2));
    if (z > -30) return -2 * std::log(0.5 * std::erfc(-z / std::numbers::sqrt2));
    return z * z + std::log(2 * std::numbers::pi * z * z);  // erfc comes near the smallest double
}

/// What is minimised over the variables of wyart_cates_variables.h.
struct Problem {
    std::span<const WyartCatesPoint> points;
    WyartCatesVariables variables;
    std::optional<HeldParameter> held = {};
    std::vector<double> log_viscosity = {};  // of the points

    Problem(std::span<const WyartCatesPoint> all, const WyartCatesVariant& variant,
            const std::optional<HeldParameter>& kept = {})
        : points(all), variables(all, variant), held(kept)
    {
        for (const WyartCatesPoint& p : points) log_viscosity.push_back(std::log(p.viscosity));
    }
};

/// ln model - ln viscosity of all points.
void find_misfits(const Problem& problem, const WyartCates& m, std::span<double> misfit)
{
    constexpr double closest = 1e-14;  // rounding must not put a flowing point beyond phi_J
    const double log_amplitude = std::log(m.amplitude);
    for (std::size_t k = 0; k < misfit.size(); ++k) {
        const WyartCatesPoint& p = problem.points[k];
        const double distance = 1 - p.volume_fraction / jamming_fraction(m, p.stress);
        misfit[k] = p.jammed && !(distance > 0)
                        ? HUGE_VAL
                        : log_amplitude - m.exponent * std::log(std::max(distance, closest)) -
                              problem.log_viscosity[k];
    }
}

/// What Eigen minimises the squares of: one residual for each point, and one that holds.
struct Residuals : Eigen::DenseFunctor<double> {
    const Problem& problem;
    double scatter;

    Residuals(const Problem& of, double width)
        : DenseFunctor(of.variables.size(),
                       static_cast<int>(of.points.size()) + of.held.has_value()),
          problem(of),
          scatter(width)
    {
    }

    int operator()(const VectorXd& x, VectorXd& residual) const
    {
        const WyartCates m = problem.variables.model(x);
        const std::size_t count = problem.points.size();
        find_misfits(problem, m, {residual.data(), count});
        for (std::size_t k = 0; k < count; ++k) {
            const WyartCatesPoint& p = problem.points[k];
            double& r = residual[static_cast<Eigen::Index>(k)];
            r = p.jammed ? std::sqrt(censored_deviance(r / scatter))
                         : r / std::hypot(p.relative_error, scatter);
        }
        constexpr double tolerance = 1e-6;
        if (const auto& held = problem.held)
            residual[residual.size() - 1] =
                std::log(value_of(m, held->parameter) / held->value) / tolerance;
        return 0;
    }

    int df(const VectorXd& x, Eigen::MatrixXd& jacobian) const
    {
        constexpr double step = 1e-5;  // the variables are of the order one
        VectorXd forward(values()), backward(values()), moved = x;
        for (Eigen::Index k = 0; k < x.size(); ++k) {
            moved[k] = x[k] + step;
            operator()(moved, forward);
            moved[k] = x[k] - step;
            operator()(moved, backward);
            moved[k] = x[k];
            jacobian.col(k) = (forward - backward) / (2 * step);
        }
        return 0;
    }
};

double deviance(const Problem& problem, std::span<const double> misfit, double scatter)
{
    double sum = 0;
    for (std::size_t k = 0; k < misfit.size(); ++k) {
        const WyartCatesPoint& p = problem.points[k];
        const double variance = p.relative_error * p.relative_error + scatter * scatter;
        sum += p.jammed
                   ? censored_deviance(misfit[k] / scatter)
                   : misfit[k] * misfit[k] / variance + std::log(2 * std::numbers::pi * variance);
    }
    return sum;
}

/// By golden sections of its logarithm.
double likeliest_scatter(const Problem& problem, std::span<const double> misfit)
{
    constexpr double section = 1 / std::numbers::phi, resolution = 1e-6;
    const auto at = [&](double logarithm) {
        return deviance(problem, misfit, std::exp(logarithm));
    };
    double low = std::log(smallest_scatter), high = std::log(largest_scatter);
    double left = high - section * (high - low), right = low + section * (high - low);
    double at_left = at(left), at_right = at(right);
    while (high - low > resolution) {
        if (at_left < at_right) {
            high = std::exchange(right, left);
            at_right = at_left;
            at_left = at(left = high - section * (high - low));
        } else {
            low = std::exchange(left, right);
            at_left = at_right;
            at_right = at(right = low + section * (high - low));
        }
    }
    return std::exp((low + high) / 2);
}

/// Moves x to the least squares; false if it has not arrived.
bool minimise(const Problem& problem, double scatter, VectorXd& x)
{
    Residuals residuals(problem, scatter);
    Eigen::LevenbergMarquardt<Residuals> method(residuals);
    method.setMaxfev(200);
    method.setFtol(1e-10);
    method.setXtol(1e-8);
    const auto status = method.minimize(x);
    return status != Eigen::LevenbergMarquardtSpace::TooManyFunctionEvaluation &&
           status != Eigen::LevenbergMarquardtSpace::ImproperInputParameters;
}

WyartCatesFit fit_from(const Problem& problem, VectorXd x, double scatter)
{
    WyartCatesFit fit;
    std::vector<double> misfit(problem.points.size());
    for (int round = 0; round < 20 && !fit.converged; ++round) {
        const bool arrived = minimise(problem, scatter, x);
        find_misfits(problem, problem.variables.model(x), misfit);
        const double better = likeliest_scatter(problem, misfit);
        fit.converged = arrived && std::abs(std::log(better / scatter)) < 1e-5;
        scatter = better;
    }
    fit.model = problem.variables.model(x);
    fit.scatter = scatter;
    fit.deviance = deviance(problem, misfit, scatter);
    fit.parameters = problem.variables.size() - problem.held.has_value();
    fit.akaike = fit.deviance + 2 * (fit.parameters + 1);
    for (std::size_t k = 0; k < misfit.size(); ++k) {
        if (problem.points[k].jammed) {
            ++fit.jammed;
            continue;
        }
        ++fit.flowing;
        fit.rms += misfit[k] * misfit[k];
    }
    fit.rms = std::sqrt(fit.rms / fit.flowing);
    return fit;
}

/// Spread over the parameters whose sum of squares can have several minima.
std::vector<VectorXd> starting_points(const Problem& problem)
{
    std::vector<VectorXd> result;
    const auto by_stress = [](const WyartCatesPoint& p, const WyartCatesPoint& q) {
        return p.stress < q.stress;
    };
    const auto [lowest, highest] =
        std::minmax_element(problem.points.begin(), problem.points.end(), by_stress);
    const double lowest_stress = lowest->stress, highest_stress = highest->stress;
    const auto& [densest, one] =
        problem.variables.limit(WyartCatesParameter::frictionless_fraction);
    const std::size_t count = problem.points.size();
    std::vector<double> misfit(count);
    constexpr int stresses = 4;
    for (int k = 0; k < stresses; ++k) {
        for (double above : {0.05, 0.3}) {
            for (double share : {0.1, 0.5}) {
                WyartCates guess = problem.variables.held();
                guess.onset_stress =
                    lowest_stress * std::pow(highest_stress / lowest_stress, (k + 0.5) / stresses);
                guess.frictionless_fraction = std::lerp(densest, one, above);
                guess.frictional_fraction =
                    std::lerp(problem.variables.lowest_frictional_fraction(guess),
                              guess.frictionless_fraction, share);
                find_misfits(problem, guess, misfit);
                double sum = 0;
                int flowing = 0;
                for (std::size_t i = 0; i < count; ++i) {
                    if (problem.points[i].jammed) continue;
                    sum += misfit[i];
                    ++flowing;
                }
                guess.amplitude = std::exp(-sum / flowing);
                result.push_back(problem.variables.variables_of(guess));
            }
        }
    }
    return result;
}

}

WyartCatesFit fit_wyart_cates(std::span<const WyartCatesPoint> points,
                              const WyartCatesVariant& variant)
{
    check_points(points, variant);
    const Problem problem(points, variant);
    constexpr double first_scatter = 0.3;
    VectorXd best;
    double lowest = HUGE_VAL;
    std::vector<double> misfit(points.size());
    for (VectorXd& x : starting_points(problem)) {
        minimise(problem, first_scatter, x);
        find_misfits(problem, problem.variables.model(x), misfit);
        const double here = deviance(problem, misfit, first_scatter);
        if (!(here < lowest)) continue;
        lowest = here;
        best = x;
    }
    return fit_from(problem, best, first_scatter);
}

WyartCatesFit refit_wyart_cates(std::span<const WyartCatesPoint> points,
                                const WyartCatesVariant& variant, const WyartCatesFit& start,
                                const std::optional<HeldParameter>& held)
{
    check_points(points, variant);
    const Problem problem(points, variant, held);
    return fit_from(problem, problem.variables.variables_of(start.model),
                    std::clamp(start.scatter, smallest_scatter, largest_scatter));
}

}
