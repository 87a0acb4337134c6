// workflows/start.h -- the packing that a step begins with: that of the suspension, or with some of
// its numbers replaced.
#pragma once
#include "engine/packing.h"
#include "io/model_fields.h"
#include "workflows/step.h"

#include <functional>
#include <optional>

namespace sigmaflow::workflows {

struct Start {
    std::optional<int> particles;
    std::optional<double> volume_fraction;
    std::optional<std::uint64_t> seed;

    void describe(io::Fields& f);
    PackingParameters packing(const Suspension& suspension) const;
    /// Sets particles, volume fraction, box and largest radius of the plan. Errors: input (denser
    /// than random close packing, a box too small for the range of the forces, both radii and
    /// particles).
    void check(const io::JsonNode& node, Plan& plan) const;
};

/// Twice the distance up to which two of the largest spheres interact [a].
double narrowest_box_allowed(double largest_radius, const Model& model);

/// A volume fraction computed from spheres and box, which meet to rounding what was asked for.
double as_asked(double volume_fraction);

/// Nothing if no packing without overlaps is found; `pulse` is called now and then.
std::optional<State> packed(const PackingParameters& packing, const std::function<void()>& pulse);

/// The model of the suspension with the changes of a step, in the box of the plan. Errors: input
/// (what check_model refuses, forces of longer range than the box has room for).
Model checked_model(const io::ModelChanges& changes, const io::JsonNode& step, const Plan& plan);

}
