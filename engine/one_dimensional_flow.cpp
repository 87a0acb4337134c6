#include "engine/one_dimensional_flow.h"

#include "engine/error.h"

#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

namespace sigmaflow {

namespace {

using Eigen::ArrayXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

void require(bool good, const std::string& problem)
{
    if (!good) throw Error(ErrorKind::input, "one-dimensional flow", problem);
}

Eigen::Index size(const GapFlow& flow)
{
    return static_cast<Eigen::Index>(flow.rate.size());
}

/// d^2/dy^2 of the deviation of the stress from that of the base state, at the centres. No flux
/// where the velocity is imposed; where the stress is, it is that of the base state.
Sparse second_derivative(const GapFlow& flow)
{
    const Eigen::Index n = size(flow);
    const double over = static_cast<double>(n) * static_cast<double>(n);
    std::vector<Eigen::Triplet<double>> entries;
    const auto face = [&](Eigen::Index below, Eigen::Index above) {
        for (const auto& [i, j] : {std::pair(below, above), std::pair(above, below)}) {
            entries.emplace_back(i, j, over);
            entries.emplace_back(i, i, -over);
        }
    };
    for (Eigen::Index j = 0; j + 1 < n; ++j) face(j, j + 1);
    if (flow.ends == GapEnds::periodic) face(n - 1, 0);
    if (flow.ends == GapEnds::imposed_stress)  // half a volume away
        for (Eigen::Index j : {Eigen::Index{0}, n - 1}) entries.emplace_back(j, j, -2 * over);
    Sparse result(n, n);
    result.setFromTriplets(entries.begin(), entries.end());
    return result;
}

/// Rates and parts, and their derivatives in time.
struct Fields {
    VectorXd rate;
    std::vector<VectorXd> parts;

    Fields plus(double factor, const Fields& other) const
    {
        Fields result = *this;
        result.rate += factor * other.rate;
        for (std::size_t i = 0; i < parts.size(); ++i) result.parts[i] += factor * other.parts[i];
        return result;
    }
};

struct Stage {
    Fields value, slope;  // slope: d value/dt
    VectorXd stress;
};

/// One volume: s at the end of an implicit step h from `before` at the rate and the stress there,
/// and how it changes with them.
struct Structure {
    double s = 0, by_rate = 0, by_stress = 0;
};

class StageSolver {
public:
    StageSolver(const Constitution& constitution, const GapFlow& flow)
        : constitution_(constitution),
          reynolds_(flow.reynolds),
          second_(second_derivative(flow)),
          identity_(second_.rows(), second_.cols())
    {
        identity_.setIdentity();
    }

    /// value = before + h slope(value); nothing if Newton's method does not converge.
    std::optional<Stage> solved(const Fields& before, const VectorXd& guess, double h) const
    {
        constexpr int most = 25;
        VectorXd stress = guess;
        for (int k = 0; k < most; ++k) {
            const VectorXd rate = before.rate + h / reynolds_ * (second_ * deviation(stress));
            VectorXd residual(stress.size()), by_rate(stress.size()), by_stress(stress.size());
            for (Eigen::Index j = 0; j < stress.size(); ++j) {
                const Structure s = structure(before, j, rate[j], stress[j], h);
                residual[j] = constitution_.stress(rate[j], s.s) - stress[j];
                const double by_s = constitution_.stress_by_s(rate[j], s.s);
                by_rate[j] = constitution_.stress_by_rate(rate[j], s.s) + by_s * s.by_rate;
                by_stress[j] = by_s * s.by_stress - 1;
            }
            if (!residual.allFinite()) return std::nullopt;
            const double scale = 1 + stress.cwiseAbs().maxCoeff();
            if (residual.cwiseAbs().maxCoeff() < 1e-13 * scale) return stage(before, stress, h);
            Sparse jacobian = by_rate.asDiagonal() * second_;
            jacobian *= h / reynolds_;
            jacobian += by_stress.asDiagonal() * identity_;
            const Eigen::SparseLU<Sparse> factors(jacobian);
            if (factors.info() != Eigen::Success) return std::nullopt;
            const VectorXd change = factors.solve(residual);
            if (!change.allFinite()) return std::nullopt;
            stress -= change;
            if (change.cwiseAbs().maxCoeff() < 1e-11 * scale) return stage(before, stress, h);
        }
        return std::nullopt;
    }

private:
    static VectorXd deviation(const VectorXd& stress) { return stress.array() - 1; }

    Structure structure(const Fields& before, Eigen::Index j, double rate, double stress,
                        double h) const
    {
        const double target = constitution_.target(stress);
        const double step = 1e-6 * (std::abs(stress) + 1e-3);
        const double target_slope =
            (constitution_.target(stress + step) - constitution_.target(stress - step)) /
            (2 * step);
        Structure result;
        for (std::size_t i = 0; i < constitution_.c.size(); ++i) {
            const double pull = h * constitution_.c[i], weight = 1 / (1 + pull * std::abs(rate));
            const double before_it = before.parts[i][j], share = constitution_.shares[i];
            result.s += share * (target + (before_it - target) * weight);
            result.by_rate -=
                share * (before_it - target) * weight * weight * pull * (rate < 0 ? -1 : 1);
            result.by_stress += share * target_slope * (1 - weight);
        }
        return result;
    }

    Stage stage(const Fields& before, const VectorXd& stress, double h) const
    {
        Stage result{.value = before, .slope = before, .stress = stress};
        result.slope.rate = second_ * deviation(stress) / reynolds_;
        result.value.rate = before.rate + h * result.slope.rate;
        const VectorXd target = stress.unaryExpr(constitution_.target);
        for (std::size_t i = 0; i < constitution_.c.size(); ++i) {
            const ArrayXd speed = constitution_.c[i] * result.value.rate.array().abs();
            result.slope.parts[i] = speed * (target - before.parts[i]).array() / (1 + h * speed);
            result.value.parts[i] = before.parts[i] + h * result.slope.parts[i];
        }
        return result;
    }

    const Constitution& constitution_;
    double reynolds_;
    Sparse second_, identity_;
};

/// One step h; divided into halves as often as `depth` says.
Stage stepped(const StageSolver& solver, const Stage& from, double h, int depth)
{
    const double a = 1 - 1 / std::numbers::sqrt2;
    if (const auto first = solver.solved(from.value, from.stress, a * h))
        if (const auto second =
                solver.solved(from.value.plus((1 - a) * h, first->slope), first->stress, a * h))
            return *second;
    if (depth == 0)
        throw Error(ErrorKind::numerics, "one-dimensional flow",
                    "the stresses do not converge in a step of " + std::to_string(h));
    const Stage middle = stepped(solver, from, h / 2, depth - 1);
    return stepped(solver, middle, h / 2, depth - 1);
}

double mode_at(GapEnds ends, int mode, double y)
{
    const double angle = mode * std::numbers::pi * y;
    if (ends == GapEnds::imposed_stress) return std::sin(angle);
    return std::cos(ends == GapEnds::periodic ? 2 * angle : angle);
}

VectorXd vector_of(std::span<const double> x)
{
    return Eigen::Map<const VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}

std::vector<double> list_of(const VectorXd& x)
{
    return {x.begin(), x.end()};
}

}

GapFlow disturbed_flow(const Constitution& constitution, GapEnds ends, double reynolds, int cells,
                       int mode, double amplitude)
{
    require(cells >= 4, "needs at least 4 cells, got " + std::to_string(cells));
    require(reynolds > 0 && std::isfinite(reynolds), "Re must be > 0");
    require(mode >= 1, "mode must be >= 1");
    GapFlow flow{.ends = ends, .reynolds = reynolds, .rate = {}, .stress = {}, .parts = {}};
    const double s = constitution.target(1);
    for (int j = 0; j < cells; ++j) {
        const double y = (j + 0.5) / cells;
        flow.rate.push_back(1 + amplitude * mode_at(ends, mode, y));
        flow.stress.push_back(constitution.stress(flow.rate.back(), s));
    }
    flow.parts.assign(constitution.c.size(), std::vector<double>(flow.rate.size(), s));
    return flow;
}

GapFlow advanced(const Constitution& constitution, const GapFlow& flow, double time)
{
    const StageSolver solver(constitution, flow);
    Stage now{.value = {vector_of(flow.rate), {}}, .slope = {}, .stress = vector_of(flow.stress)};
    for (const auto& part : flow.parts) now.value.parts.push_back(vector_of(part));
    constexpr int deepest = 10;
    const Stage end = stepped(solver, now, time, deepest);
    GapFlow result = flow;
    result.time += time;
    result.rate = list_of(end.value.rate);
    result.stress = list_of(end.stress);
    for (std::size_t i = 0; i < result.parts.size(); ++i)
        result.parts[i] = list_of(end.value.parts[i]);
    return result;
}

std::vector<double> velocities(const GapFlow& flow)
{
    std::vector<double> result{0};
    for (double rate : flow.rate)
        result.push_back(result.back() + rate / static_cast<double>(flow.rate.size()));
    return result;
}

double mode_amplitude(const GapFlow& flow, std::span<const double> field, int mode)
{
    const auto n = static_cast<double>(field.size());
    double sum = 0;
    for (std::size_t j = 0; j < field.size(); ++j)
        sum += (field[j] - 1) * mode_at(flow.ends, mode, (static_cast<double>(j) + 0.5) / n);
    return 2 * sum / n;
}

}
