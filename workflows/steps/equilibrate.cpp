// Step "equilibrate": shear until the flow is stationary.
#include "engine/statistics.h"
#include "workflows/averages.h"
#include "workflows/run_files.h"
#include "workflows/shearing.h"
#include "workflows/steps.h"

#include <cmath>

namespace sigmaflow::workflows {

namespace {

struct Equilibrate {
    ShearingParameters shearing;
    double minimum_strain = 1, maximum_strain = 5, window = 0.5;
    double tolerance = 2, relative_tolerance = 0.05;

    void describe(io::Fields& f)
    {
        shearing.describe(f);
        f("minimum_strain", minimum_strain, io::above_to(0, 1e4), "-",
          "shear at least so far; at least two windows");
        f("maximum_strain", maximum_strain, io::above_to(0, 1e4), "-",
          "stop here even if the flow is not stationary (the summary says so)");
        f("window", window, io::above_to(0, 1e4), "strain",
          "the means of the last two windows are compared");
        f("tolerance", tolerance, io::at_least(0), "standard errors",
          "stationary if the means differ by less than this many combined standard errors");
        f("relative_tolerance", relative_tolerance, io::between(0, 1), "-",
          "or by less than this share of their mean");
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        const Control control = shearing.check(node, plan, maximum_strain);
        if (minimum_strain < 2 * window)
            throw node.error_at_key("minimum_strain",
                                    "must be >= 2 * window = " + io::number_text(2 * window) +
                                        ", got " + io::number_text(minimum_strain));
        if (maximum_strain < minimum_strain)
            throw node.error_at_key(
                "maximum_strain", "must be >= minimum_strain = " + io::number_text(minimum_strain) +
                                      ", got " + io::number_text(maximum_strain));
        if (window < 4 * shearing.series_interval)
            throw node.error_at_key("window", "must be >= 4 * series_interval = " +
                                                  io::number_text(4 * shearing.series_interval) +
                                                  ", got " + io::number_text(window));
        plan.changes_state = true;
        plan.needs.frames = 1;
        plan.runs.push_back(plan.shears(control, maximum_strain, 0));
    }

    /// Compares the last two windows of the series.
    bool is_stationary(std::span<const Sample> series) const
    {
        const auto rows = static_cast<std::size_t>(std::lround(window / shearing.series_interval));
        if (series.size() < 2 * rows || series.back().strain < minimum_strain - 1e-9) return false;
        const auto value = shearing.rate ? &Sample::shear_stress : &Sample::shear_rate;
        const Estimate late = estimate_mean(column(series.last(rows), value));
        const Estimate early =
            estimate_mean(column(series.subspan(series.size() - 2 * rows, rows), value));
        const double difference = std::abs(late.mean - early.mean);
        return difference <= tolerance * std::hypot(late.standard_error, early.standard_error) ||
               difference <= relative_tolerance * std::abs(late.mean + early.mean) / 2;
    }

    void run(Context& context) const
    {
        const ShearingTask task =
            shearing.task(context.suspension.model, maximum_strain, 0, context.threads);
        RunFiles files(context, task.model, task.control, false);
        bool stationary = false;
        const ShearingResult result =
            shear(context, task, files, [&] { return stationary = is_stationary(files.series()); });
        const double last_rate = files.last_sample().shear_rate;
        Run& run = files.finish();
        run.jammed = result.outcome == Outcome::jammed;
        context.results["control"] = control_json(task.control);
        context.results.update(shearing_json(context.state, result));
        if (!run.jammed) context.results["outcome"] = stationary ? "stationary" : "not stationary";
        context.results["last_shear_rate"] = last_rate;
    }
};

}

StepKind equilibrate_step()
{
    return step_kind<Equilibrate>("equilibrate",
                                  "shear until the means of two successive strain windows agree");
}

}
