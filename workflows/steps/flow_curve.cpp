// Step "flow_curve": shear rate against shear stress from all runs before it.
#include "workflows/curve_report.h"
#include "workflows/pictures.h"
#include "workflows/steps.h"

namespace sigmaflow::workflows {

namespace {

struct FlowCurve {
    double confidence = 0.95;
    PictureSize size;
    std::vector<PlannedRun> runs;  // of steps "shear", known when the step is validated

    void describe(io::Fields& f)
    {
        f("confidence", confidence, io::between(0.5, 0.9999), "-",
          "of all statements on one curve together");
        size.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        runs = runs_for_curves(node, plan);
        plan.needs.plotted_pixels = size.pixels();
        plan.endings = {"", "_viscosity"};
    }

    void run(Context& context) const
    {
        report_curves(context, curves_of(context, runs), confidence, size);
    }
};

}

StepKind flow_curve_step()
{
    return step_kind<FlowCurve>("flow_curve",
                                "shear rate against stress with error bars: continuous, S-shaped "
                                "or arch-shaped?");
}

}
