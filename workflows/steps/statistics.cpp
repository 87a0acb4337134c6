// Step "statistics": means, errors and correlations of a run, and whether they can be trusted.
#include "engine/statistics.h"
#include "io/atomic_file.h"
#include "workflows/averages.h"
#include "workflows/pictures.h"
#include "workflows/steps.h"

#include <cmath>

namespace sigmaflow::workflows {

namespace {

bool is_clock(const SampleField& field)
{
    return field.name == "strain" || field.name == "time";
}

struct Statistics {
    std::string of, y = "shear_rate";
    PictureSize size;

    void describe(io::Fields& f)
    {
        f("of", of, 64, "name of a shearing step; default: the last one before this step");
        f("y", y, field_names(), "scalar of the time series in the pictures");
        size.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        plan.need_run(node, of, false);
        plan.needs.plotted_pixels = 2 * size.pixels();
        plan.endings = {"_correlation", "_blocks"};
    }

    static std::string csv_text(std::span<const Sample> samples, double interval)
    {
        std::string text =
            "# after the start-up; correlation_strain: integrated correlation time; errors of the "
            "mean from autocorrelation and from blocks; reliable: the error is good to a third\n"
            "scalar,mean,standard_error,autocorrelation_error,blocking_error,correlation_strain,"
            "samples,effective_samples,reliable\n";
        for (const SampleField& field : sample_fields()) {
            if (is_clock(field)) continue;
            const Estimate e = estimate_mean(column(samples, field.value));
            text += std::string(field.name);
            for (double value : {e.mean, e.standard_error, e.autocorrelation_error,
                                 e.blocking_error, e.correlation_time * interval})
                text += "," + io::number_text(value);
            text += "," + std::to_string(e.used) + "," + io::number_text(e.effective_samples) +
                    (e.reliable ? ",true\n" : ",false\n");
        }
        return text;
    }

    render::Plot empty_plot(const Run& run) const
    {
        render::Plot plot = size.plot();
        plot.title = title_text(run.volume_fraction, run.control, run.particles);
        return plot;
    }

    render::Plot correlation_plot(const Run& run, const std::vector<double>& series,
                                  const Estimate& estimate, double interval) const
    {
        render::Plot plot = empty_plot(run);
        plot.x.title = "strain $γ$";
        plot.y.title = "autocorrelation of the " + axis_text(field_named(y));
        const int lags = static_cast<int>(std::ceil(10 * estimate.correlation_time)) + 10;
        render::Series rho, zero;
        rho.y = autocorrelation(series, lags);
        for (std::size_t k = 0; k < rho.y.size(); ++k)
            rho.x.push_back(static_cast<double>(k) * interval);
        rho.label =
            "integrated correlation strain " + short_number(estimate.correlation_time * interval);
        zero.x = {rho.x.front(), rho.x.back()};
        zero.y = {0, 0};
        zero.line = render::Line::dashed;
        zero.line_width = 1.5;
        zero.colour = render::Colour{60, 60, 60};
        plot.series = {std::move(rho), std::move(zero)};
        return plot;
    }

    render::Plot block_plot(const Run& run, const std::vector<double>& series,
                            const Estimate& estimate, double interval) const
    {
        render::Plot plot = empty_plot(run);
        plot.x.title = "strain of a block";
        plot.y.title = "standard error of the mean " + axis_text(field_named(y));
        plot.x.logarithmic = true;
        plot.y.minimum = 0;
        render::Series blocks, used;
        blocks.label = "from blocks";
        blocks.marker = render::Marker::circle;
        for (const BlockError& block : block_errors(series)) {
            blocks.x.push_back(block.length * interval);
            blocks.y.push_back(block.error);
            blocks.y_error.push_back(block.error / std::sqrt(2. * (block.blocks - 1)));
        }
        used.label = "used";
        used.x = {blocks.x.front(), blocks.x.back()};
        used.y = {estimate.standard_error, estimate.standard_error};
        used.line = render::Line::dashed;
        plot.series = {std::move(blocks), std::move(used)};
        return plot;
    }

    void run(Context& context) const
    {
        const Run& run = context.run(of);
        context.results["of"] = of;
        const std::span<const Sample> samples = stationary_part(run);
        if (run.jammed || samples.size() < 4) {
            context.results["outcome"] =
                run.jammed ? "no means, the run jammed" : "no means, the run is too short";
            return;
        }
        const double interval = samples[1].strain - samples[0].strain;
        const std::vector<double> series = column(samples, field_named(y).value);
        const Estimate estimate = estimate_mean(series);
        io::write_file(context.folder.file(context.step_name + ".csv"),
                       csv_text(samples, interval));
        context.results["outcome"] = estimate.reliable
                                         ? "errors are reliable"
                                         : "too few independent samples, errors are guesses";
        context.results["correlation_strain"] = estimate.correlation_time * interval;
        context.results.update(averages_json(run));
        if (estimate.standard_error == 0) return;  // nothing fluctuates: nothing to draw
        write_plot(context, context.step_name + "_correlation",
                   correlation_plot(run, series, estimate, interval));
        write_plot(context, context.step_name + "_blocks",
                   block_plot(run, series, estimate, interval));
    }
};

}

StepKind statistics_step()
{
    return step_kind<Statistics>(
        "statistics", "means, errors and correlations of a run, and whether they can be trusted");
}

}
