// Step "stability": up to which Reynolds number is the uniform flow of a flow curve stable?
#include "io/atomic_file.h"
#include "workflows/falling_intervals.h"
#include "workflows/pictures.h"
#include "workflows/steps.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::ordered_json;

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

/// Growth of the first mode over gaps, in intervals with an onset.
std::string map_text(const std::vector<Interval>& falling)
{
    std::string text =
        "# gap [sqrt(eta0/(rho rate0))]; reynolds: rho rate gap^2/viscosity; growth, frequency: of "
        "the first mode [shear rate]\n"
        "volume_fraction,stress,gap,reynolds,growth,frequency\n";
    for (const Interval& i : falling) {
        constexpr int points = 40;
        const double critical = i.onset->reynolds.mean;
        for (int k = 0; k <= points; ++k) {
            const double reynolds = critical * std::pow(10, -1 + 5. * k / points);
            const auto root = growth_rates(i.flow, reynolds)[0];
            text += io::number_text(i.volume_fraction);
            for (double value : {i.stress(), gap_of(reynolds, i.rate(), i.flow.viscosity.mean),
                                 reynolds, root.real(), std::abs(root.imag())})
                text += "," + io::number_text(value);
            text += "\n";
        }
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
            {"frequency_at_onset", i.onset->frequency},
            {"growth_at_imposed_rate", growth_at_imposed_rate(i.flow)},
            {"gap",
             {{"mean", gap_of(i.onset->reynolds.mean, i.rate(), i.flow.viscosity.mean)},
              {"unit", "sqrt(eta0/(rho rate0))"}}},
            {"growing_roots_at_twice_critical",
             {{"by_polynomial", growing_roots(i.flow, 2 * i.onset->reynolds.mean)},
              {"by_argument_principle", unstable_roots(i.flow, 2 * i.onset->reynolds.mean)}}}};
}

struct Stability {
    MemoryParameters memory;
    PictureSize size;
    std::vector<PlannedRun> runs;  // of steps "shear", known when the step is validated

    void describe(io::Fields& f)
    {
        memory.describe(f);
        size.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        memory.validate(node, plan);
        runs = runs_for_curves(node, plan);
        memory.use(plan, runs);
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

    /// The gaps of equal growth against the stress: 0, the border of stability, for each volume
    /// fraction, and growth for the one that is least stable.
    render::Plot map_plot(const std::vector<Interval>& drawn) const
    {
        render::Plot result = size.plot();
        result.title = "Gaps in which uniform flow is stable (below) and unstable (above)";
        result.x.title = "shear stress $σ$/$σ$_{0}";
        result.y.title = "gap $H$ ($ρ$ $γ̇$_{0}/$η$_{0})^{1/2}";
        result.x.logarithmic = result.y.logarithmic = true;
        const auto line = [&](double volume_fraction, double growth, const std::string& label) {
            render::Series series;
            series.label = label;
            for (const Interval& i : drawn) {
                if (i.volume_fraction != volume_fraction) continue;
                const auto reynolds = reynolds_of_growth(i.flow, growth);
                if (!reynolds) continue;
                series.x.push_back(i.stress());
                series.y.push_back(gap_of(*reynolds, i.rate(), i.flow.viscosity.mean));
            }
            return series;
        };
        const std::vector<Interval> worst = least_stable(drawn);
        double lowest = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < worst.size(); ++k) {
            render::Series border =
                line(worst[k].volume_fraction, 0,
                     "$ϕ$ = " + short_number(worst[k].volume_fraction) + ", border");
            border.marker = render::Marker::circle;
            border.colour = render::cycle_colour(k);
            for (double gap : border.y) lowest = std::min(lowest, gap);
            result.series.push_back(std::move(border));
        }
        result.y.minimum = lowest / 4;  // room for the legend
        const auto least =
            std::min_element(worst.begin(), worst.end(), [](const Interval& a, const Interval& b) {
                return a.onset->reynolds.mean < b.onset->reynolds.mean;
            });
        const auto colour = render::cycle_colour(static_cast<std::size_t>(least - worst.begin()));
        for (const auto& [growth, style] :
             {std::pair(3., render::Line::dashed), std::pair(10., render::Line::dotted)}) {
            render::Series contour = line(least->volume_fraction, growth,
                                          "$ϕ$ = " + short_number(least->volume_fraction) +
                                              ", growth rate " + short_number(growth) + " $γ̇$");
            contour.line = style;
            contour.marker = render::Marker::diamond;
            contour.open_marker = true;
            contour.colour = colour;
            if (!contour.x.empty()) result.series.push_back(std::move(contour));
        }
        return result;
    }

    void analyse(Context& context) const
    {
        const std::vector<Interval> all = intervals_of(curves_of(context, runs), memory);
        io::write_file(context.folder.file(context.step_name + ".csv"), csv_text(all));
        std::vector<Interval> falling, drawn;
        for (const Interval& i : all)
            if (i.onset) falling.push_back(i);
        std::copy_if(falling.begin(), falling.end(), std::back_inserter(drawn),
                     [](const Interval& i) { return i.is_drawn(); });
        context.results["memory"] = memory.json();
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
        io::write_file(context.folder.file(context.step_name + "_map.csv"), map_text(falling));
        write_plot(context, context.step_name, critical_plot(drawn));
        write_plot(context, context.step_name + "_growth", growth_plot(least_stable(drawn)));
        write_plot(context, context.step_name + "_map", map_plot(drawn));
    }

    void run(Context& context) const { run_with_memory(*this, context, &Stability::analyse); }
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
