// Step "pack": a random packing without overlaps at exactly the asked volume fraction.
#include "io/case_file.h"
#include "workflows/checkpoint.h"
#include "workflows/start.h"
#include "workflows/steps.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow::workflows {

namespace {

struct Pack {
    Start start;

    void describe(io::Fields& f) { start.describe(f); }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        start.check(node, plan);
        plan.has_state = plan.changes_state = true;
    }

    void run(Context& context) const
    {
        const PackingParameters parameters = start.packing(context.suspension);
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
