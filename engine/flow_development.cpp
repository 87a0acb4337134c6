#include "engine/flow_development.h"

#include "engine/error.h"
#include "engine/exponents.h"
#include "engine/one_dimensional_flow.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sigmaflow {

namespace {

using Complex = std::complex<double>;

Moment moment_of(const GapFlow& flow)
{
    return {.time = flow.time,
            .amplitude = mode_amplitude(flow, flow.rate, 1),
            .mean_rate = velocities(flow).back(),
            .middle_stress = flow.stress[flow.stress.size() / 2],
            .rate = flow.rate};
}

std::optional<Complex> measured_growth(const std::vector<Moment>& moments,
                                       const std::vector<Complex>& roots,
                                       const DevelopmentPlan& plan)
{
    constexpr double died_out = 8, linear = 1e-3, rounding = 1e-10;
    constexpr std::size_t fewest = 12;
    const double from = roots.size() > 2 ? died_out / (roots[0].real() - roots[2].real()) : 0;
    std::vector<double> series;
    for (const Moment& m : moments) {
        if (std::abs(m.amplitude) > linear) break;
        if (plan.disturbance * std::exp(roots[0].real() * m.time) < rounding) break;
        if (m.time >= from) series.push_back(m.amplitude);
    }
    if (series.size() < fewest) return std::nullopt;
    Complex x = exponents_of(series, plan.step * plan.steps_between_samples)[0];
    return Complex(x.real(), std::abs(x.imag()));
}

double largest_amplitude(const std::vector<Moment>& moments, std::size_t from, std::size_t to)
{
    double result = 0;
    for (std::size_t k = from; k < to; ++k)
        result = std::max(result, std::abs(moments[k].amplitude));
    return result;
}

/// From the times at which the amplitude passes 0 upwards.
double frequency_of(const std::vector<Moment>& moments, std::size_t from)
{
    double first = 0, last = 0;
    int passes = 0;
    for (std::size_t k = from + 1; k < moments.size(); ++k) {
        const Moment &a = moments[k - 1], &b = moments[k];
        if (!(a.amplitude < 0 && b.amplitude >= 0)) continue;
        last = a.time + (b.time - a.time) * a.amplitude / (a.amplitude - b.amplitude);
        if (passes++ == 0) first = last;
    }
    return passes > 1 ? 2 * std::numbers::pi * (passes - 1) / (last - first) : 0;
}

void judge(Development& result, const DevelopmentPlan& plan)
{
    const auto& moments = result.moments;
    const std::size_t half = moments.size() / 2, last = moments.size() * 3 / 4;
    for (std::size_t k = last; k < moments.size(); ++k) {
        const auto [low, high] =
            std::minmax_element(moments[k].rate.begin(), moments[k].rate.end());
        result.smallest_rate = std::min(result.smallest_rate, *low);
        result.largest_rate = std::max(result.largest_rate, *high);
    }
    result.frequency = frequency_of(moments, last);
    const double before = largest_amplitude(moments, half, last),
                 now = largest_amplitude(moments, last, moments.size());
    constexpr double steady = 1.2, small = 1e-3;
    if (now < plan.disturbance && now < before)
        result.fate = Fate::decays;
    else if (now > small && now < steady * before && before < steady * now)
        result.fate = Fate::oscillates;
}

}

DevelopmentPlan plan_development(const MemoryFlow& theory, double reynolds, double disturbance)
{
    if (!(disturbance > 0 && disturbance < 0.1))
        throw Error(ErrorKind::input, "flow development", "disturbance must be > 0 and < 0.1");
    DevelopmentPlan plan{.reynolds = reynolds, .disturbance = disturbance};
    const std::vector<Complex> roots = growth_rates(theory, reynolds);
    const double fastest = std::max(std::abs(roots[0]), std::abs(roots[1]));
    plan.step = 1 / (40 * fastest);
    const double growth = roots[0].real();
    const double turn = 1 / std::max(std::abs(roots[0].imag()), std::abs(growth));
    const double oscillations = 10 * 2 * std::numbers::pi * turn;
    plan.time = growth > 0 ? std::log(1 / disturbance) / growth + oscillations
                           : 8 / std::max(-growth, 1e-3 * fastest);
    constexpr double most = 40000;
    plan.time = std::min(plan.time, most * plan.step);
    return plan;
}

Development develop(const Constitution& constitution, const MemoryFlow& theory,
                    const DevelopmentPlan& plan)
{
    const std::vector<Complex> roots = growth_rates(theory, plan.reynolds);
    Development result{.moments = {}, .expected = roots[0]};
    GapFlow flow = disturbed_flow(constitution, GapEnds::imposed_stress, plan.reynolds, plan.cells,
                                  1, plan.disturbance);
    result.moments.push_back(moment_of(flow));
    const auto steps = static_cast<long>(plan.time / plan.step);
    try {
        for (long k = 1; k <= steps; ++k) {
            flow = advanced(constitution, flow, plan.step);
            if (k % plan.steps_between_samples == 0) result.moments.push_back(moment_of(flow));
        }
    } catch (const Error& error) {  // what came before is a result
        if (error.kind() != ErrorKind::numerics) throw;
        result.broke_off = true;
    }
    result.measured = measured_growth(result.moments, roots, plan);
    judge(result, plan);
    return result;
}

}
