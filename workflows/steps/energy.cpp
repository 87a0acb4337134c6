// Step "energy": the power put in against what is stored and dissipated, at every stored frame.
#include "engine/power_balance.h"
#include "engine/statistics.h"
#include "io/atomic_file.h"
#include "workflows/averages.h"
#include "workflows/pictures.h"
#include "workflows/steps.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::ordered_json;

std::string csv_text(const std::vector<Power>& series)
{
    std::string text =
        "# powers [eta0 rate0^2 a^3]; input: imposed stress (or the measured one, if the rate is "
        "imposed) times rate times volume; residual: (input - sum of all others)/(largest of all)\n"
        "strain,shear_rate,input";
    for (const PowerField& field : power_fields()) text += "," + std::string(field.name);
    text += ",residual\n";
    for (const Power& p : series) {
        for (double value : {p.strain, p.shear_rate, p.input}) text += io::number_text(value) + ",";
        for (const PowerField& field : power_fields())
            text += io::number_text(p.*field.value) + ",";
        text += io::number_text(p.residual) + "\n";
    }
    return text;
}

std::vector<double> column(const std::vector<Power>& series, double Power::*value)
{
    std::vector<double> result;
    for (const Power& p : series) result.push_back(p.*value);
    return result;
}

/// More than a thousandth of the input at some frame.
bool is_seen(const std::vector<Power>& series, const PowerField& field)
{
    return std::any_of(series.begin(), series.end(), [&](const Power& p) {
        return std::abs(p.*field.value) > 1e-3 * std::abs(p.input);
    });
}

struct Energy {
    std::string of;
    PictureSize size;

    void describe(io::Fields& f)
    {
        f("of", of, 64, "name of a step \"shear\"; default: the last one before this step");
        size.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        const PlannedRun& run = plan.need_run(node, of, true);
        plan.needs.frames_read = run.frames;
        plan.needs.plotted_pixels = size.pixels();
    }

    /// Powers over the mean input; what is stored is one curve.
    render::Plot plot(const Run& run, const std::vector<Power>& series, double mean_input) const
    {
        render::Plot plot = size.plot();
        plot.title = title_text(run.volume_fraction, run.control, run.particles);
        plot.x.title = "strain $γ$";
        plot.y.title = "power/mean input";
        double highest = 0;
        const auto add = [&](std::string label, std::vector<double> powers, render::Line line) {
            std::replace(label.begin(), label.end(), '_', ' ');
            for (double& power : powers) power /= mean_input;
            highest = std::max(highest, *std::max_element(powers.begin(), powers.end()));
            render::Series one;
            one.label = label;
            one.x = column(series, &Power::strain);
            one.y = std::move(powers);
            one.line = line;
            one.line_width = 2;
            if (series.size() == 1) one.marker = render::Marker::circle;
            plot.series.push_back(std::move(one));
        };
        add("input", column(series, &Power::input), render::Line::solid);
        plot.series[0].colour = render::Colour{20, 20, 26};
        std::vector<double> stored(series.size());
        for (const PowerField& field : power_fields()) {
            const std::vector<double> powers = column(series, field.value);
            if (!field.stored && is_seen(series, field))
                add(std::string(field.name), powers, render::Line::solid);
            for (std::size_t i = 0; field.stored && i < stored.size(); ++i) stored[i] += powers[i];
        }
        add("stored in springs and repulsion", stored, render::Line::dashed);
        plot.y.maximum = highest / (0.95 - 0.055 * static_cast<double>(plot.series.size()));
        return plot;
    }

    /// Mean powers after the start-up over the mean input.
    static Json shares_json(const std::vector<Power>& part)
    {
        const double input = estimate_mean(column(part, &Power::input)).mean;
        Json shares = Json::object();
        if (input == 0) return shares;
        for (const PowerField& field : power_fields()) {
            const Estimate mean = estimate_mean(column(part, field.value));
            shares[std::string(field.name)] = {
                {"mean", mean.mean / input},
                {"standard_error", mean.standard_error / std::abs(input)},
                {"meaning", field.meaning}};
        }
        return shares;
    }

    void run(Context& context) const
    {
        const Run& run = context.run(of);
        context.results["of"] = of;
        const io::StoredRun stored = io::read_run(run.file);
        if (stored.frames.empty()) {
            context.results["outcome"] = "nothing to say, no frames are stored";
            return;
        }
        Workspace workspace;
        std::vector<Power> series, stationary;
        for (const Frame& frame : stored.frames) {
            series.push_back(evaluate_power(frame.state, stored.model, stored.control, workspace));
            if (run.start_up && frame.state.strain >= *run.start_up)
                stationary.push_back(series.back());
        }
        io::write_file(context.folder.file(context.step_name + ".csv"), csv_text(series));
        double largest = 0;
        for (const Power& p : series) largest = std::max(largest, std::abs(p.residual));
        context.results["frames"] = series.size();
        context.results["largest_residual"] = largest;
        context.results["outcome"] = largest < tolerance
                                         ? "power put in is power stored and dissipated"
                                         : "the power does not balance";
        if (!stationary.empty()) {
            context.results["frames_after_start_up"] = stationary.size();
            context.results["shares_of_input"] = shares_json(stationary);
        }
        const double input = estimate_mean(column(series, &Power::input)).mean;
        if (!(std::abs(input) > 0)) {
            context.results["picture"] = "none, no power is put in";
            return;
        }
        write_plot(context, context.step_name, plot(run, series, input));
    }

    static constexpr double tolerance = 1e-6;  // frames are solved directly
};

}

StepKind energy_step()
{
    return step_kind<Energy>("energy",
                             "power put in against power stored and dissipated at every frame");
}

}
