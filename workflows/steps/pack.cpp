// Step "pack": a random packing without overlaps at exactly the asked volume fraction.
#include "engine/packing.h"
#include "io/case_file.h"
#include "workflows/checkpoint.h"
#include "workflows/pictures.h"
#include "workflows/steps.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow::workflows {

namespace {

double largest_radius(const PackingParameters& packing)
{
    if (packing.radii.empty()) return packing.small_volume_share < 1 ? packing.size_ratio : 1;
    return *std::max_element(packing.radii.begin(), packing.radii.end());
}

struct Pack {
    std::optional<double> volume_fraction;
    std::optional<std::uint64_t> seed;

    void describe(io::Fields& f)
    {
        f("volume_fraction", volume_fraction, io::above_to(0, 1), "-",
          "instead of that of the suspension");
        f("seed", seed, "instead of that of the suspension");
    }

    PackingParameters packing(const Suspension& suspension) const
    {
        PackingParameters packing = suspension.packing;
        packing.volume_fraction = volume_fraction.value_or(packing.volume_fraction);
        packing.seed = seed.value_or(packing.seed);
        return packing;
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        if (const auto value = node.find("volume_fraction"))
            plan.suspension.check_volume_fraction(*volume_fraction, *value);
        const PackingParameters parameters = packing(plan.suspension);
        const Model& model = plan.suspension.model;
        const double range = std::max(model.lubrication_range, model.repulsion_range);
        const double least = 2 * largest_radius(parameters) * (2 + range);
        const double narrowest = packing_box(parameters).minCoeff();
        if (narrowest < least)
            throw node.error("too few particles: the box would be " + short_number(narrowest) +
                             " a wide, must be >= " + io::number_text(least) +
                             " a, twice the distance up to which two of the largest spheres "
                             "interact");
        plan.has_state = plan.changes_state = true;
        plan.volume_fraction = parameters.volume_fraction;
    }

    void run(Context& context) const
    {
        const PackingParameters parameters = packing(context.suspension);
        // the smallest xi goes from about -1 to -0.01, ever more slowly
        const auto report = [&](int iteration, double smallest_xi) {
            context.keeper.stop_if_asked();
            const double fraction =
                1 - std::log(std::max(-smallest_xi, 0.01) / 0.01) / std::log(100);
            context.progress.update(fraction, "iteration " + std::to_string(iteration) +
                                                  ", smallest gap " + io::number_text(smallest_xi));
        };
        context.state = random_packing(parameters, report);
        context.last_run.clear();
        io::write_case(context.folder.file(context.step_name + "/state.json"), context.state,
                       context.suspension.model, ImposedStress{1});
        context.results["particles"] = context.state.size();
        context.results["volume_fraction"] = sigmaflow::volume_fraction(context.state);
        context.results["seed"] = parameters.seed;
        const Vec3& box = context.state.box.length;
        context.results["box"] = {box.x(), box.y(), box.z()};
    }
};

}

StepKind pack_step()
{
    return step_kind<Pack>("pack", "random packing of the suspension, without overlaps");
}

}
