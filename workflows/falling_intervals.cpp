#include "workflows/falling_intervals.h"

#include <cmath>

namespace sigmaflow::workflows {

namespace {

/// Slope and viscosity in the middle. Their errors share those of the two rates; the slope's, which
/// is far larger in relation, is taken as independent.
Interval interval(double volume_fraction, const Measured& a, const Measured& b,
                  const MemoryParameters& memory)
{
    const double width = b.stress.mean - a.stress.mean;
    const double rate = (a.rate.mean + b.rate.mean) / 2;
    const double error = std::hypot(a.rate.standard_error, b.rate.standard_error);
    Interval result{.volume_fraction = volume_fraction, .from = a.stress.mean, .to = b.stress.mean};
    const double viscosity = result.stress() / rate;
    result.flow = memory.flow({viscosity, viscosity * error / 2 / rate},
                              {(b.rate.mean - a.rate.mean) / width, error / width});
    result.onset = onset_of_instability(result.flow);
    return result;
}

}

std::vector<Interval> intervals_of(const Curves& curves, const MemoryParameters& memory)
{
    std::vector<Interval> result;
    for (const auto& [volume_fraction, curve] : curves) {
        const Measured* before = nullptr;
        for (const auto& [stress, m] : curve.by_stress) {
            if (m.jammed || !(m.rate.mean > 0)) break;
            if (before) result.push_back(interval(volume_fraction, *before, m, memory));
            before = &m;
        }
    }
    return result;
}

std::vector<Interval> least_stable(const std::vector<Interval>& falling)
{
    std::vector<Interval> result;
    for (const Interval& i : falling) {
        if (result.empty() || result.back().volume_fraction != i.volume_fraction)
            result.push_back(i);
        else if (i.onset->reynolds.mean < result.back().onset->reynolds.mean)
            result.back() = i;
    }
    return result;
}

}
