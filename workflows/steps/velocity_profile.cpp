// Step "velocity_profile": is the flow uniform? Mean velocity in slabs across the gradient
// direction.
#include "engine/velocity_profile.h"
#include "io/atomic_file.h"
#include "workflows/averages.h"
#include "workflows/pictures.h"
#include "workflows/steps.h"

namespace sigmaflow::workflows {

namespace {

struct Profiles {
    std::vector<double> strain;  // of each profile
    std::vector<VelocityProfile> instantaneous;
    MeanProfile mean;
};

/// One row per slab: centre, mean, error, volume fraction, then every instantaneous profile.
std::string csv_text(const Profiles& profiles)
{
    std::string text =
        "# y: slab centre over L_y; u: U_x/(shear_rate L_y); u_at_<strain>: one frame\n"
        "y,u,standard_error,volume_fraction";
    for (double strain : profiles.strain) text += ",u_at_" + io::number_text(strain);
    const MeanProfile& mean = profiles.mean;
    for (std::size_t k = 0; k < mean.y.size(); ++k) {
        text += '\n';
        text += io::number_text(mean.y[k]);
        const auto add = [&](double value) { text.append(1, ',').append(io::number_text(value)); };
        add(mean.u[k]);
        add(mean.standard_error[k]);
        add(mean.volume_fraction[k]);
        for (const VelocityProfile& one : profiles.instantaneous) add(one.u[k]);
    }
    return text + "\n";
}

std::string number_of_units(double strain)
{
    return strain == 1 ? "strain unit" : short_number(strain) + " strain units";
}

render::Plot profile_plot(const Profiles& profiles, double spacing, const PictureSize& size)
{
    render::Plot plot = size.plot();
    plot.x.title = "$U_{x}$/($γ̇$ $L_{y}$)";
    plot.y.title = "$y$/$L_{y}$";
    plot.y.minimum = 0;
    plot.y.maximum = 1;
    for (std::size_t i = 0; i < profiles.instantaneous.size(); ++i) {
        render::Series one;
        one.label = i == 0 ? "instantaneous, every " + number_of_units(spacing) : "";
        one.x = profiles.instantaneous[i].u;
        one.y = profiles.instantaneous[i].y;
        one.line_width = 1.2;
        one.colour = render::Colour{150, 170, 200};
        plot.series.push_back(std::move(one));
    }
    render::Series linear;
    linear.label = "uniform shear";
    linear.x = linear.y = {0, 1};
    linear.line = render::Line::dashed;
    linear.colour = render::Colour{60, 60, 60};
    plot.series.push_back(std::move(linear));
    render::Series mean;
    mean.label = "mean";
    mean.x = profiles.mean.u;
    mean.y = profiles.mean.y;
    if (profiles.mean.profiles > 1) mean.x_error = profiles.mean.standard_error;
    mean.line = render::Line::none;
    mean.marker = render::Marker::circle;
    mean.colour = render::Colour{200, 60, 30};
    plot.series.push_back(std::move(mean));
    return plot;
}

struct VelocityProfileStep {
    std::string of;
    int bins = 20;
    double spacing = 1;
    std::optional<double> from_strain;
    PictureSize size{1440, 1080};

    void describe(io::Fields& f)
    {
        f("of", of, 64, "name of a step \"shear\"; default: the last one before this step");
        f("bins", bins, io::Integers{2, 1000}, "-", "slabs across the gradient direction");
        f("spacing", spacing, io::above_to(0, 1e4), "strain",
          "strain between two instantaneous profiles");
        f("from_strain", from_strain, io::between(0, 1e4), "-",
          "strain of the first profile; default: where the start-up ends");
        size.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        const PlannedRun& run = plan.need_run(node, of, true);
        check_within(run, node, "from_strain", from_strain);
        plan.needs.plotted_pixels = size.pixels();
    }

    Profiles profiles_of(const Run& run) const
    {
        const io::StoredRun stored = io::read_run(run.file);
        constexpr double rounding = 1e-9;
        double next = from_strain.value_or(run.start_up.value_or(0)) - rounding;
        Profiles result;
        for (const Frame& frame : stored.frames) {
            if (frame.state.strain < next) continue;
            result.strain.push_back(frame.state.strain);
            result.instantaneous.push_back(
                velocity_profile(frame.state, frame.velocity, frame.sample.shear_rate, bins));
            next = frame.state.strain + spacing - rounding;
        }
        result.mean = mean_profile(result.instantaneous);
        return result;
    }

    void run(Context& context) const
    {
        const Run& run = context.run(of);
        context.results["of"] = of;
        if (run.jammed) {
            context.results["outcome"] = "no profile, the suspension is jammed";
            return;
        }
        const Profiles profiles = profiles_of(run);
        io::write_file(context.folder.file(context.step_name + ".csv"), csv_text(profiles));
        render::Plot plot = profile_plot(profiles, spacing, size);
        plot.title = title_text(run.volume_fraction, run.control, run.particles);
        write_plot(context, context.step_name, plot);

        const Uniformity& uniformity = profiles.mean.uniformity;
        context.results["profiles"] = profiles.mean.profiles;
        context.results["from_strain"] = profiles.strain.front();
        context.results["largest_deviation"] = uniformity.largest_deviation;
        context.results["rms_deviation"] = uniformity.rms_deviation;
        context.results["chi2_per_bin"] = uniformity.chi2_per_bin;
        context.results["slope"] = {
            {"mean", uniformity.slope}, {"standard_error", uniformity.slope_error}, {"unit", "-"}};
    }
};

}

StepKind velocity_profile_step()
{
    return step_kind<VelocityProfileStep>(
        "velocity_profile",
        "velocity across the gradient direction: instantaneous, mean and error");
}

}
