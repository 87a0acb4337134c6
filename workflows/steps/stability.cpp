// Step "stability": up to which Reynolds number is the uniform flow of a flow curve stable?
#include "engine/stability.h"
#include "io/atomic_file.h"
#include "workflows/measured_curves.h"
#include "workflows/pictures.h"
#include "workflows/steps.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::ordered_json;

/// Between two neighbouring stresses of a curve.
struct Interval {
    double volume_fraction = 0, from = 0, to = 0;  // stresses [sigma0]
    UniformFlow flow = {};
    std::optional<Onset> onset = {};

    double stress() const { return (from + to) / 2; }
    /// The critical Reynolds number is known, but for an error smaller than itself; others stand in
    /// the table only.
    bool is_drawn() const { return onset->reynolds.standard_error < onset->reynolds.mean; }
};

/// Slope and viscosity in the middle. Their errors share those of the two rates; the slope's, which
/// is far larger in relation, is taken as independent.
Interval interval(double volume_fraction, const Measured& a, const Measured& b, Value relaxation)
{
    const double width = b.stress.mean - a.stress.mean;
    const double rate = (a.rate.mean + b.rate.mean) / 2;
    const double error = std::hypot(a.rate.standard_error, b.rate.standard_error);
    Interval result{.volume_fraction = volume_fraction, .from = a.stress.mean, .to = b.stress.mean};
    const double viscosity = result.stress() / rate;
    result.flow = {.viscosity = {viscosity, viscosity * error / 2 / rate},
                   .slope = {(b.rate.mean - a.rate.mean) / width, error / width},
                   .relaxation = relaxation};
    result.onset = onset_of_instability(result.flow);
    return result;
}

/// Jammed points, and rates that are not positive, end a curve.
std::vector<Interval> intervals_of(const Curves& curves, Value relaxation)
{
    std::vector<Interval> result;
    for (const auto& [volume_fraction, curve] : curves) {
        const Measured* before = nullptr;
        for (const auto& [stress, m] : curve.by_stress) {
            if (m.jammed || !(m.rate.mean > 0)) break;
            if (before) result.push_back(interval(volume_fraction, *before, m, relaxation));
            before = &m;
        }
    }
    return result;
}

/// The interval with the smallest Re_c of each volume fraction.
std::vector<Interval> least_stable(const std::vector<Interval>& falling)
{
    std::vector<Interval> result;
    for (const Interval& i : falling) {
        if (result.empty() || result.back().volume_fraction != i.volume_fraction)
            result.push_back(i);
        else if (i.onset->reynolds.mean < result.back().onset->reynolds.mean)
            result.back() = i;
    }
    return result;
}

std::string csv_text(const std::vector<Interval>& intervals)
{
    std::string text =
        "# slope: d shear_rate/d stress [1/eta0]; critical_reynolds: Re = rho rate H^2/viscosity "
        "up to which uniform flow in a gap H is stable, empty: at all; frequency: angular, at "
        "onset [shear rate]\n"
        "volume_fraction,from_stress,to_stress,viscosity,viscosity_error,slope,slope_error,"
        "critical_reynolds,critical_reynolds_error,frequency\n";
    for (const Interval& i : intervals) {
        text += io::number_text(i.volume_fraction);
        for (double value : {i.from, i.to, i.flow.viscosity.mean, i.flow.viscosity.standard_error,
                             i.flow.slope.mean, i.flow.slope.standard_error})
            text += "," + io::number_text(value);
        if (const auto& onset = i.onset)
            text += "," + io::number_text(onset->reynolds.mean) + "," +
                    io::number_text(onset->reynolds.standard_error) + "," +
                    io::number_text(onset->frequency) + "\n";
        else
            text += ",,,\n";
    }
    return text;
}

Json interval_json(const Interval& i)
{
    return {{"volume_fraction", i.volume_fraction},
            {"from_stress", i.from},
            {"to_stress", i.to},
            {"slope",
             {{"mean", i.flow.slope.mean},
              {"standard_error", i.flow.slope.standard_error},
              {"unit", "1/eta0"}}},
            {"critical_reynolds",
             {{"mean", i.onset->reynolds.mean},
              {"standard_error", i.onset->reynolds.standard_error},
              {"unit", "-"}}},
            {"frequency_at_onset", i.onset->frequency}};
}

struct Stability {
    double relaxation_strain = 0.023, relaxation_strain_error = 0;
    PictureSize size;
    std::vector<PlannedRun> runs;  // of steps "shear", known when the step is validated

    void describe(io::Fields& f)
    {
        f("relaxation_strain", relaxation_strain, io::between(1e-6, 100), "-",
          "1/c: the microstructure follows a step in stress over this strain; default: Mari et al. "
          "2015, phi = 0.58, stress 2 to 3");
        f("relaxation_strain_error", relaxation_strain_error, io::between(0, 100), "-",
          "its standard error");
        size.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        runs = runs_for_curves(node, plan);
        plan.needs.plotted_pixels = size.pixels();
    }

    /// Re_c in the middle of the falling intervals, a series for each volume fraction.
    render::Plot critical_plot(const std::vector<Interval>& falling) const
    {
        render::Plot result = size.plot();
        result.title = "Uniform flow is stable below";
        result.x.title = "shear stress $σ$/$σ$_{0}";
        result.y.title = "critical Reynolds number $ρ$ $γ̇$ $H$^{2}/$η$";
        result.x.logarithmic = result.y.logarithmic = true;
        const Interval* before = nullptr;
        for (const Interval& i : falling) {
            if (!before || before->volume_fraction != i.volume_fraction) {
                render::Series series;
                series.label = "$ϕ$ = " + short_number(i.volume_fraction);
                series.marker = render::Marker::circle;
                series.line_width = 1.2;
                result.series.push_back(std::move(series));
            }
            before = &i;
            render::Series& series = result.series.back();
            series.x.push_back(i.stress());
            series.y.push_back(i.onset->reynolds.mean);
            series.y_error.push_back(i.onset->reynolds.standard_error);
        }
        return result;
    }

    /// Growth of the first mode against Re in these intervals.
    render::Plot growth_plot(const std::vector<Interval>& intervals) const
    {
        render::Plot result = size.plot();
        result.x.logarithmic = true;
        result.title = "Growth of the first mode where the flow is least stable";
        result.x.title = "Reynolds number $ρ$ $γ̇$ $H$^{2}/$η$";
        result.y.title = "growth rate/$γ̇$";
        for (const Interval& i : intervals) {
            render::Series series;
            series.label = "$ϕ$ = " + short_number(i.volume_fraction) +
                           ", $σ$/$σ$_{0} = " + short_number(i.stress());
            constexpr int points = 200;
            for (int k = 0; k <= points; ++k) {
                const double reynolds =
                    i.onset->reynolds.mean * std::pow(10, -0.5 + 2.5 * k / points);
                series.x.push_back(reynolds);
                series.y.push_back(growth_rates(i.flow, reynolds)[0].real());
            }
            result.series.push_back(std::move(series));
        }
        render::Series zero;
        for (const render::Series& series : result.series)
            zero.x.insert(zero.x.end(), {series.x.front(), series.x.back()});
        std::sort(zero.x.begin(), zero.x.end());
        zero.y.assign(zero.x.size(), 0);
        zero.line = render::Line::dashed;
        zero.line_width = 1.5;
        zero.colour = render::Colour{60, 60, 60};
        result.series.push_back(std::move(zero));
        return result;
    }

    void run(Context& context) const
    {
        const Value relaxation{1 / relaxation_strain,
                               relaxation_strain_error / relaxation_strain / relaxation_strain};
        const std::vector<Interval> all = intervals_of(curves_of(context, runs), relaxation);
        io::write_file(context.folder.file(context.step_name + ".csv"), csv_text(all));
        std::vector<Interval> falling, drawn;
        for (const Interval& i : all)
            if (i.onset) falling.push_back(i);
        std::copy_if(falling.begin(), falling.end(), std::back_inserter(drawn),
                     [](const Interval& i) { return i.is_drawn(); });
        context.results["relaxation_strain"] = relaxation_strain;
        context.results["least_stable"] = Json::array();
        for (const Interval& i : least_stable(falling))
            context.results["least_stable"].push_back(interval_json(i));
        if (all.empty())
            context.results["outcome"] = "nothing to say, no two neighbouring stresses flow";
        else if (falling.empty())
            context.results["outcome"] = "stable at all Reynolds numbers, the rate falls nowhere";
        else if (drawn.empty())
            context.results["outcome"] = "no picture, all errors are larger than the values";
        if (drawn.empty()) return;
        write_plot(context, context.step_name, critical_plot(drawn));
        write_plot(context, context.step_name + "_growth", growth_plot(least_stable(drawn)));
    }
};

}

StepKind stability_step()
{
    return step_kind<Stability>(
        "stability",
        "critical Reynolds number of uniform flow where the rate falls with "
        "the stress");
}

}
