#include "engine/jamming.h"

#include "engine/ensemble.h"
#include "engine/error.h"
#include "engine/workspace.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sigmaflow {

double force_residual(const State& state, const Model& model, const Control& control)
{
    Workspace workspace;
    Evaluation e = prepare(state, model, control, nullptr, workspace.buffers());
    list_pairs(state, e, workspace);
    std::vector<Vec3> net(state.size(), Vec3::Zero());
    double largest = 0, residual = 0;
    for (const PairState& p : e.pairs) {
        Vec3 force = -p.repulsion * p.pair.normal;
        if (p.contact >= 0) force += e.contacts[p.contact].force_on_i;
        net[p.pair.i] += force;
        net[p.pair.j] -= force;
        largest = std::max(largest, force.norm());
    }
    for (const Vec3& f : net) residual = std::max(residual, f.norm());
    return largest > 0 ? residual / largest : 0;
}

JammingMonitor::JammingMonitor(double stress, const JammingCriterion& criterion)
    : criterion_(criterion),
      stress_(stress),
      duration_(criterion.strain * criterion.viscosity / stress)
{
}

bool JammingMonitor::observe(const State& state, const Evaluation& e)
{
    if (!started_) {
        started_ = true;
        start_time_ = state.time;
        start_strain_ = state.strain;
    }
    const double elapsed = state.time - start_time_;
    if (elapsed < duration_) return false;
    window_.duration = elapsed;
    window_.strain_gain = state.strain - start_strain_;
    window_.mean_viscosity = window_.strain_gain > 0 ? stress_ * elapsed / window_.strain_gain
                                                     : std::numeric_limits<double>::infinity();
    window_.force_residual = force_residual(state, e.model, e.control);
    window_.jammed = window_.mean_viscosity > criterion_.viscosity &&
                     window_.force_residual < criterion_.residual;
    start_time_ = state.time;
    start_strain_ = state.strain;
    return window_.jammed;
}

JammingBracket bracket_jamming_stress(double low, double high, double ratio,
                                      const std::function<bool(double)>& jams)
{
    if (!(low > 0 && high > low && ratio > 1))
        throw Error(ErrorKind::input, "jamming stress", "needs 0 < low < high and ratio > 1");
    if (jams(low)) return {0, low};
    if (!jams(high)) return {high, 0};
    while (high > ratio * low) {
        const double middle = std::sqrt(low * high);
        (jams(middle) ? high : low) = middle;
    }
    return {low, high};
}

Value jamming_stress(std::span<const JammingBracket> brackets)
{
    std::vector<std::vector<double>> middles;
    double widths = 0;  // squared
    for (const JammingBracket& b : brackets) {
        if (!(b.flows > 0 && b.jams > b.flows))
            throw Error(ErrorKind::input, "jamming stress", "needs brackets with two ends");
        middles.push_back({(std::log(b.flows) + std::log(b.jams)) / 2});
        widths += std::pow(std::log(b.jams / b.flows), 2);
    }
    const EnsembleMean mean = ensemble_mean(middles);
    const double n = static_cast<double>(brackets.size());
    const double stress = std::exp(mean.mean[0]);
    return {stress, stress * std::hypot(mean.standard_error[0], std::sqrt(widths / 12) / n)};
}

}
