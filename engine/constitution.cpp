#include "engine/constitution.h"

#include "engine/error.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace sigmaflow {

namespace {

void require(bool good, const std::string& problem)
{
    if (!good) throw Error(ErrorKind::input, "constitution", problem);
}

/// Shares and relaxations of the kernel.
Constitution with_memory(const MemoryKernel& kernel)
{
    check(kernel);
    const double sum = 1 - kernel.instantaneous;
    require(sum != 0, "the kernel has no memory");
    Constitution result;
    for (const MemoryTerm& term : kernel.terms) {
        result.shares.push_back(term.weight.mean / sum);
        result.c.push_back(term.c.mean);
    }
    return result;
}

/// The derivative at a point between two secants.
double monotone(double left, double right, double before, double after)
{
    if (left * right <= 0) return 0;  // an extreme
    const double share = (1 + after / (before + after)) / 3;
    return left * right / (share * right + (1 - share) * left);
}

/// `wanted` as far as the piece with this secant stays monotone.
double end_derivative(double wanted, double secant)
{
    if (wanted * secant <= 0) return 0;
    return std::copysign(std::min(std::abs(wanted), 3 * std::abs(secant)), wanted);
}

/// Rate and its derivative with ln stress within a piece, at the fraction t of its width.
struct Piece {
    double rate = 0, derivative = 0;
};

Piece hermite(const SteadyCurve& curve, std::size_t k, double t)
{
    const double width = curve.logarithm[k + 1] - curve.logarithm[k];
    const double a = curve.rate[k], b = curve.rate[k + 1];
    const double da = curve.derivative[k] * width, db = curve.derivative[k + 1] * width;
    const double c2 = 3 * (b - a) - 2 * da - db, c3 = 2 * (a - b) + da + db;
    return {a + t * (da + t * (c2 + t * c3)), (da + t * (2 * c2 + t * 3 * c3)) / width};
}

Piece at(const SteadyCurve& curve, double stress)
{
    const auto& x = curve.logarithm;
    const double logarithm = std::log(stress);
    if (logarithm >= x.back() && curve.jams) return {};
    if (logarithm <= x.front() || logarithm >= x.back()) {  // a constant viscosity
        const std::size_t end = logarithm <= x.front() ? 0 : x.size() - 1;
        const double rate = stress * curve.rate[end] / std::exp(x[end]);
        return {rate, rate};
    }
    const auto above = std::upper_bound(x.begin(), x.end(), logarithm);
    const auto k = static_cast<std::size_t>(above - x.begin()) - 1;
    return hermite(curve, k, (logarithm - x[k]) / (x[k + 1] - x[k]));
}

}

double SteadyCurve::shear_rate(double stress) const
{
    return stress > 0 ? at(*this, stress).rate : 0;
}

double SteadyCurve::slope(double stress) const
{
    const double lowest = std::exp(logarithm.front());
    return at(*this, std::max(stress, lowest / 2)).derivative / std::max(stress, lowest / 2);
}

double SteadyCurve::steepest_fall(double from, double to) const
{
    constexpr int points = 200;
    double best = from, least = 0;
    for (int k = 0; k <= points; ++k) {
        const double stress = from * std::pow(to / from, static_cast<double>(k) / points);
        const Piece here = at(*this, stress);
        if (!(here.rate > 0)) break;
        const double slope = here.derivative / here.rate;
        if (k > 0 && slope >= least) continue;
        best = stress;
        least = slope;
    }
    return best;
}

SteadyCurve steady_curve(std::span<const FlowPoint> points)
{
    std::vector<FlowPoint> sorted(points.begin(), points.end());
    std::sort(sorted.begin(), sorted.end(),
              [](const FlowPoint& a, const FlowPoint& b) { return a.stress < b.stress; });
    SteadyCurve curve;
    for (const FlowPoint& p : sorted) {
        require(p.stress > 0 && std::isfinite(p.stress) && (p.jammed || p.shear_rate > 0) &&
                    std::isfinite(p.shear_rate),
                "needs stresses and rates > 0");
        curve.logarithm.push_back(std::log(p.stress));
        curve.rate.push_back(p.jammed ? 0 : p.shear_rate);
        curve.jams = p.jammed;
        if (p.jammed) break;
    }
    const std::size_t n = curve.rate.size();
    require(n >= (curve.jams ? 3u : 2u), "needs two stresses that flow");
    std::vector<double> width, secant;
    for (std::size_t k = 0; k + 1 < n; ++k) {
        width.push_back(curve.logarithm[k + 1] - curve.logarithm[k]);
        require(width.back() > 0, "has two points at one stress");
        secant.push_back((curve.rate[k + 1] - curve.rate[k]) / width.back());
    }
    curve.derivative.push_back(end_derivative(curve.rate.front(), secant.front()));
    for (std::size_t k = 1; k + 1 < n; ++k)
        curve.derivative.push_back(monotone(secant[k - 1], secant[k], width[k - 1], width[k]));
    curve.derivative.push_back(curve.jams ? secant.back()
                                          : end_derivative(curve.rate.back(), secant.back()));
    return curve;
}

SteadyRate over_base(const SteadyCurve& curve, double stress)
{
    const double base = curve.shear_rate(stress);
    require(base > 0, "nothing flows at the stress " + std::to_string(stress));
    return [curve, stress, base](double x) { return curve.shear_rate(x * stress) / base; };
}

Constitution viscous_constitution(const SteadyRate& steady, const MemoryKernel& kernel)
{
    require(std::abs(kernel.instantaneous) < 1e-9,
            "an instantaneous part needs the contact stress as microstructure");
    Constitution result = with_memory(kernel);
    result.stress = [](double rate, double s) { return rate / s; };
    result.stress_by_rate = [](double, double s) { return 1 / s; };
    result.stress_by_s = [](double rate, double s) { return -rate / (s * s); };
    result.target = [steady](double stress) {
        const double size = std::max(std::abs(stress), 1e-9);
        return steady(size) / size;
    };
    return result;
}

Constitution contact_constitution(const SteadyRate& steady, const MemoryKernel& kernel,
                                  double instantaneous_viscosity)
{
    require(instantaneous_viscosity > 0 && std::isfinite(instantaneous_viscosity),
            "instantaneous viscosity must be > 0, got " + std::to_string(instantaneous_viscosity));
    Constitution result = with_memory(kernel);
    const double eta = instantaneous_viscosity;
    result.stress = [eta](double rate, double s) { return eta * rate + s; };
    result.stress_by_rate = [eta](double, double) { return eta; };
    result.stress_by_s = [](double, double) { return 1.; };
    result.target = [steady, eta](double stress) {
        return stress - eta * std::copysign(steady(std::abs(stress)), stress);
    };
    return result;
}

}
