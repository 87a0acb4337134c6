#include "workflows/start.h"

#include "workflows/pictures.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow::workflows {

namespace {

double largest_radius(const PackingParameters& packing)
{
    if (packing.radii.empty()) return packing.small_volume_share < 1 ? packing.size_ratio : 1;
    return *std::max_element(packing.radii.begin(), packing.radii.end());
}

}

double narrowest_box_allowed(double largest_radius, const Model& model)
{
    return 2 * largest_radius * (2 + std::max(model.lubrication_range, model.repulsion_range));
}

double as_asked(double volume_fraction)
{
    return std::round(volume_fraction * 1e9) / 1e9;
}

void Start::describe(io::Fields& f)
{
    f("particles", particles, io::Integers{2, 1'000'000}, "-", "instead of that of the suspension");
    f("volume_fraction", volume_fraction, io::above_to(0, 1), "-",
      "instead of that of the suspension");
    f("seed", seed, "instead of that of the suspension");
}

PackingParameters Start::packing(const Suspension& suspension) const
{
    PackingParameters packing = suspension.packing;
    packing.particles = particles.value_or(packing.particles);
    packing.volume_fraction = volume_fraction.value_or(packing.volume_fraction);
    packing.seed = seed.value_or(packing.seed);
    return packing;
}

void Start::check(const io::JsonNode& node, Plan& plan) const
{
    plan.need_suspension(node);
    const PackingParameters parameters = packing(plan.suspension);
    if (particles && !parameters.radii.empty())
        throw node.error_at_key("particles", "the radii of the suspension say how many there are");
    if (const auto value = node.find("volume_fraction"))
        plan.suspension.check_volume_fraction(*volume_fraction, *value);
    plan.narrowest_box = packing_box(parameters).minCoeff();
    plan.largest_radius = largest_radius(parameters);
    const double least = narrowest_box_allowed(plan.largest_radius, plan.suspension.model);
    if (plan.narrowest_box < least)
        throw node.error("too few particles: the box would be " + short_number(plan.narrowest_box) +
                         " a wide, must be >= " + io::number_text(least) +
                         " a, twice the distance up to which two of the largest spheres interact");
    plan.particles = parameters.particles;
    plan.volume_fraction = parameters.volume_fraction;
}

std::optional<State> packed(const PackingParameters& packing, const std::function<void()>& pulse)
{
    try {
        return random_packing(packing, [&](int, double) { pulse(); });
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::numerics) throw;
        return std::nullopt;
    }
}

Model checked_model(const io::ModelChanges& changes, const io::JsonNode& step, const Plan& plan)
{
    const Model model = changes.applied_to(plan.suspension.model);
    const auto given = step.find("model");
    if (!given) return model;
    io::check_model(model, *given);
    if (plan.narrowest_box < narrowest_box_allowed(plan.largest_radius, model))
        throw given->error("forces of this range need a wider box, more particles");
    return model;
}

}
