// Step "shear": shear at an imposed stress or rate and record what happens.
#include "workflows/averages.h"
#include "workflows/run_files.h"
#include "workflows/shearing.h"
#include "workflows/steps.h"

#include <cmath>

namespace sigmaflow::workflows {

namespace {

struct Shear {
    ShearingParameters shearing;
    double strain = 5, frame_interval = 0.25;

    void describe(io::Fields& f)
    {
        f("strain", strain, io::above_to(0, 1e4), "-", "strain of this step, counted from 0");
        shearing.describe(f);
        f("frame_interval", frame_interval, io::between(1e-6, 1e4), "strain",
          "strain between two stored frames of all particles");
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        const Control control = shearing.check(node, plan, strain);
        constexpr double most_frames = 99999;
        if (strain / frame_interval > most_frames)
            throw node.error_at_key(
                "frame_interval",
                "gives more than 99999 frames, the strain is " + io::number_text(strain));
        plan.changes_state = true;
        plan.needs.frames = std::floor(strain / frame_interval) + 2;
        plan.runs.push_back(plan.shears(control, strain, plan.needs.frames));
    }

    void run(Context& context) const
    {
        const ShearingTask task =
            shearing.task(context.suspension.model, strain, frame_interval, context.threads);
        const Control& control = task.control;
        RunFiles files(context, task.model, control, true);
        const ShearingResult result = shear(context, task, files);
        Run& run = files.finish();
        run.jammed = result.outcome == Outcome::jammed;
        context.results["control"] = control_json(control);
        context.results["volume_fraction"] = run.volume_fraction;
        context.results.update(shearing_json(context.state, result));
        if (run.jammed) return;  // there is no stationary flow to average
        find_start_up(run);
        context.results.update(averages_json(run));
    }
};

}

StepKind shear_step()
{
    return step_kind<Shear>("shear", "shear at an imposed stress or rate and record the flow");
}

}
