// Step "plot": a scalar of the time series against strain or time.
#include "engine/statistics.h"
#include "workflows/averages.h"
#include "workflows/pictures.h"
#include "workflows/report.h"
#include "workflows/steps.h"

#include <limits>

namespace sigmaflow::workflows {

namespace {

constexpr render::Colour mean_colour{213, 94, 0};

struct Plot {
    std::string of, x = "strain", y = "shear_rate";
    bool show_start_up = true, logarithmic = false;
    PictureSize size;

    void describe(io::Fields& f)
    {
        f("of", of, 64, "name of a shearing step; default: the last one before this step");
        f("y", y, field_names(), "scalar of the time series");
        f("x", x, std::vector<std::string_view>{"strain", "time"}, "against strain or time");
        f("show_start_up", show_start_up,
          "also the run that this one continues, e.g. equilibrate, at negative strains");
        f("logarithmic", logarithmic, "logarithmic y axis; values <= 0 leave a gap");
        size.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        plan.need_run(node, of, false);
        plan.needs.plotted_pixels = size.pixels();
    }

    /// The mean after the start-up with its standard error, and the start-up shaded.
    void mark_mean(const Run& run, const std::vector<double>& x_values, render::Plot& plot) const
    {
        const std::span<const Sample> part = stationary_part(run);
        if (!run.start_up || part.empty()) return;
        const Estimate mean = estimate_mean(column(part, field_named(y).value));
        const double from = part.front().*field_named(x).value, to = x_values.back();
        const double low = mean.mean - mean.standard_error, high = mean.mean + mean.standard_error;
        if (logarithmic && low <= 0) return;
        if (from > x_values.front())
            plot.spans.push_back({x_values.front(), from, "start-up, left out"});
        plot.bands.push_back({"standard error", {from, to}, {low, low}, {high, high}, mean_colour});
        render::Series line;
        line.label = "mean " + with_error(mean.mean, mean.standard_error, " ± ");
        line.x = {from, to};
        line.y = {mean.mean, mean.mean};
        line.line = render::Line::dashed;
        line.colour = mean_colour;
        plot.series.push_back(std::move(line));
    }

    /// The run before this one, moved so that it ends where this one begins.
    void add_run_before(const Context& context, const Run& run, render::Series& data) const
    {
        if (!show_start_up || run.continues.empty()) return;
        const Run& before = context.run(run.continues);
        if (before.series.empty()) return;
        data.x = column(before.series, field_named(x).value);
        data.y = column(before.series, field_named(y).value);
        const double end = data.x.back();
        for (double& value : data.x) value -= end;
    }

    void run(Context& context) const
    {
        const Run& run = context.run(of);
        render::Plot plot = size.plot();
        plot.title = title_text(run.volume_fraction, run.control, run.particles);
        plot.x.title = axis_text(field_named(x));
        plot.y.title = axis_text(field_named(y));
        plot.y.logarithmic = logarithmic;
        render::Series data;
        add_run_before(context, run, data);
        for (const Sample& sample : run.series) {
            data.x.push_back(sample.*field_named(x).value);
            data.y.push_back(sample.*field_named(y).value);
        }
        data.line_width = 2;
        if (logarithmic)  // a rate can be negative for a while: a gap in the curve
            for (double& value : data.y)
                if (value <= 0) value = std::numeric_limits<double>::quiet_NaN();
        const std::vector<double> x_values = data.x;
        plot.series.push_back(std::move(data));
        if (!x_values.empty()) mark_mean(run, x_values, plot);
        write_plot(context, context.step_name, plot);
    }
};

}

StepKind plot_step()
{
    return step_kind<Plot>("plot", "curve of a scalar with its mean, as PNG and SVG");
}

}
