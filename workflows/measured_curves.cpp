#include "workflows/measured_curves.h"

#include "workflows/averages.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow::workflows {

double Measured::viscosity_error() const
{
    return std::abs(viscosity()) *
           std::hypot(stress.standard_error / stress.mean, rate.standard_error / rate.mean);
}

std::vector<PlannedRun> runs_for_curves(const io::JsonNode& node, const Plan& plan)
{
    std::vector<PlannedRun> runs;
    std::map<double, std::vector<double>> stresses;  // by volume fraction
    for (const PlannedRun& run : plan.runs) {
        if (run.frames == 0) continue;  // equilibrate
        runs.push_back(run);
        if (const auto* stress = std::get_if<ImposedStress>(&run.control))
            stresses[run.volume_fraction].push_back(stress->value);
    }
    for (auto& [volume_fraction, list] : stresses) {
        std::sort(list.begin(), list.end());
        if (list.front() == list.back())
            throw node.error(
                "needs runs at two stresses at least, there is only one at the "
                "volume fraction " +
                io::number_text(volume_fraction));
    }
    for (const PlannedRun& run : runs)
        if (run.particles != runs.front().particles)
            throw node.error("needs runs of one number of particles, there are some of " +
                             std::to_string(runs.front().particles) + " and " +
                             std::to_string(run.particles));
    if (stresses.empty())
        throw node.error(
            "needs steps \"shear\" at imposed stresses before it, e.g. with "
            "\"sweep\": {\"stress\": [0.5, 1, 2]}");
    return runs;
}

Measured measured(const Run& run)
{
    const std::span<const Sample> samples = stationary_part(run);
    const auto mean = [&](double Sample::*value) { return estimate_mean(column(samples, value)); };
    Measured result{.run = run.name,
                    .jammed = run.jammed,
                    .stress = mean(&Sample::shear_stress),
                    .rate = mean(&Sample::shear_rate),
                    .contact_number = mean(&Sample::contact_number)};
    if (const auto* rate = std::get_if<ImposedRate>(&run.control)) {
        result.imposed_rate = true;
        result.rate = {.mean = rate->value};
    } else {
        result.stress = {.mean = std::get<ImposedStress>(run.control).value};
        if (run.jammed) result.rate = {};
    }
    return result;
}

Curves curves_of(const Context& context, const std::vector<PlannedRun>& planned)
{
    Curves curves;
    for (const PlannedRun& one : planned) {
        Measured m = measured(context.run(one.name));
        Curve& curve = curves[one.volume_fraction];
        if (m.imposed_rate)
            curve.by_rate[m.rate.mean] = std::move(m);
        else
            curve.by_stress[m.stress.mean] = std::move(m);
    }
    return curves;
}

}
