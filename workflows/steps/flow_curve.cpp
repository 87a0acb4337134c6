// Step "flow_curve": shear rate against shear stress from all runs before it.
#include "engine/flow_curve.h"
#include "engine/statistics.h"
#include "io/atomic_file.h"
#include "workflows/averages.h"
#include "workflows/pictures.h"
#include "workflows/steps.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::ordered_json;

/// The mean flow of one run.
struct Measured {
    std::string run;
    bool imposed_rate = false, jammed = false;
    Estimate stress, rate, contact_number;  // what is imposed has no error

    double viscosity() const { return stress.mean / rate.mean; }
    double viscosity_error() const
    {
        return std::abs(viscosity()) *
               std::hypot(stress.standard_error / stress.mean, rate.standard_error / rate.mean);
    }
    FlowPoint point() const { return {stress.mean, rate.mean, rate.standard_error, jammed}; }
};

/// One volume fraction, as it was asked for; by the imposed stress or rate.
struct Curve {
    std::map<double, Measured> by_stress, by_rate;
};
using Curves = std::map<double, Curve>;

Measured measured(const Run& run)
{
    const std::span<const Sample> samples = stationary_part(run);
    const auto mean = [&](double Sample::*value) { return estimate_mean(column(samples, value)); };
    Measured result{.run = run.name,
                    .jammed = run.jammed,
                    .stress = mean(&Sample::shear_stress),
                    .rate = mean(&Sample::shear_rate),
                    .contact_number = mean(&Sample::contact_number)};
    if (const auto* rate = std::get_if<ImposedRate>(&run.control)) {
        result.imposed_rate = true;
        result.rate = {.mean = rate->value};
    } else {
        result.stress = {.mean = std::get<ImposedStress>(run.control).value};
        if (run.jammed) result.rate = {};
    }
    return result;
}

/// Of two runs at one stress or rate the later one counts.
Curves curves_of(const Context& context, const std::vector<PlannedRun>& planned)
{
    Curves curves;
    for (const PlannedRun& one : planned) {
        Measured m = measured(context.run(one.name));
        Curve& curve = curves[one.volume_fraction];
        if (m.imposed_rate)
            curve.by_rate[m.rate.mean] = std::move(m);
        else
            curve.by_stress[m.stress.mean] = std::move(m);
    }
    return curves;
}

std::string row(double volume_fraction, const Measured& m)
{
    std::string text = io::number_text(volume_fraction) + (m.imposed_rate ? ",rate" : ",stress");
    for (double value : {m.stress.mean, m.stress.standard_error, m.rate.mean, m.rate.standard_error,
                         m.viscosity(), m.viscosity_error(), m.contact_number.mean}) {
        text += ',';
        if (std::isfinite(value)) text += io::number_text(value);  // jammed: no viscosity
    }
    return text + (m.jammed ? ",jammed," : ",flowing,") + m.run + "\n";
}

std::string csv_text(const Curves& curves)
{
    std::string text =
        "# stress [sigma0], shear_rate [rate0], viscosity [eta0]; errors are standard errors\n"
        "volume_fraction,control,stress,stress_error,shear_rate,shear_rate_error,viscosity,"
        "viscosity_error,contact_number,outcome,run\n";
    for (const auto& [volume_fraction, curve] : curves)
        for (const auto* points : {&curve.by_stress, &curve.by_rate})
            for (const auto& [imposed, m] : *points) text += row(volume_fraction, m);
    return text;
}

std::string label(double volume_fraction, const CurveAnalysis& analysis)
{
    std::string text =
        "$ϕ$ = " + short_number(volume_fraction) + ", " + std::string(shape_name(analysis.shape));
    if (analysis.jams) text += ", jams at $σ$/$σ$_{0} = " + short_number(analysis.jamming_stress);
    return text;
}

/// Viscosity against rate, or rate against stress; what has no place on logarithmic axes is left
/// out.
render::Series drawn(const std::map<double, Measured>& points, bool viscosity,
                     const std::string& label, std::optional<render::Colour> colour = {})
{
    render::Series series;
    series.label = label;
    series.marker = render::Marker::circle;
    series.colour = colour;
    for (const auto& [imposed, m] : points) {
        if (m.jammed || !(m.rate.mean > 0) || !(m.stress.mean > 0)) continue;
        const Estimate& x = viscosity ? m.rate : m.stress;
        series.x.push_back(x.mean);
        series.x_error.push_back(x.standard_error);
        series.y.push_back(viscosity ? m.viscosity() : m.rate.mean);
        series.y_error.push_back(viscosity ? m.viscosity_error() : m.rate.standard_error);
    }
    return series;
}

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
        std::map<double, std::vector<double>> stresses;  // by volume fraction
        for (const PlannedRun& run : plan.runs) {
            if (run.frames == 0) continue;  // equilibrate
            runs.push_back(run);
            if (const auto* stress = std::get_if<ImposedStress>(&run.control))
                stresses[run.volume_fraction].push_back(stress->value);
        }
        for (auto& [volume_fraction, list] : stresses) {
            std::sort(list.begin(), list.end());
            if (list.front() == list.back())
                throw node.error(
                    "needs runs at two stresses at least, there is only one at the "
                    "volume fraction " +
                    io::number_text(volume_fraction));
        }
        if (stresses.empty())
            throw node.error(
                "needs steps \"shear\" at imposed stresses before it, e.g. with "
                "\"sweep\": {\"stress\": [0.5, 1, 2]}");
        plan.needs.plotted_pixels = size.pixels();
    }

    static Json slope_json(const Slope& s)
    {
        static constexpr const char* trends[] = {"rises", "falls", "unknown"};
        return {{"from_stress", s.from},
                {"to_stress", s.to},
                {"slope", s.slope},
                {"confidence_interval", {s.lower, s.upper}},
                {"trend", trends[static_cast<int>(s.trend)]}};
    }

    static Json curve_json(double volume_fraction, const CurveAnalysis& analysis)
    {
        Json json = {{"volume_fraction", volume_fraction}, {"shape", shape_name(analysis.shape)}};
        if (analysis.jams) json["jamming_stress"] = analysis.jamming_stress;
        if (analysis.fall) json["most_certain_fall"] = slope_json(*analysis.fall);
        for (const Slope& s : analysis.slopes) json["slopes"].push_back(slope_json(s));
        return json;
    }

    render::Plot plot(const char* title) const
    {
        render::Plot plot;
        plot.width = size.width;
        plot.height = size.height;
        plot.title = title;
        plot.x.logarithmic = plot.y.logarithmic = true;
        return plot;
    }

    void run(Context& context) const
    {
        const Curves curves = curves_of(context, runs);
        io::write_file(context.folder.file(context.step_name + ".csv"), csv_text(curves));
        render::Plot rates = plot("Flow curves"), viscosities = plot("Viscosity");
        rates.x.title = "shear stress $σ$/$σ$_{0}";
        rates.y.title = viscosities.x.title = "shear rate $γ̇$/$γ̇$_{0}";
        viscosities.y.title = "viscosity $η$/$η$_{0}";
        context.results["confidence"] = confidence;
        auto& list = context.results["curves"] = Json::array();
        std::size_t number = 0;
        for (const auto& [volume_fraction, curve] : curves) {
            const render::Colour colour = render::cycle_colour(number++);
            const std::string name = "$ϕ$ = " + short_number(volume_fraction);
            if (curve.by_stress.size() > 1) {
                std::vector<FlowPoint> points;
                for (const auto& [stress, m] : curve.by_stress) points.push_back(m.point());
                const CurveAnalysis analysis = analyse_flow_curve(points, confidence);
                list.push_back(curve_json(volume_fraction, analysis));
                rates.series.push_back(
                    drawn(curve.by_stress, false, label(volume_fraction, analysis), colour));
                viscosities.series.push_back(drawn(curve.by_stress, true, name, colour));
            }
            if (curve.by_rate.empty()) continue;
            for (render::Plot* plot : {&rates, &viscosities}) {
                render::Series crosses =
                    drawn(curve.by_rate, plot == &viscosities, name + ", imposed rate", colour);
                crosses.line = render::Line::none;
                crosses.marker = render::Marker::cross;
                plot->series.push_back(std::move(crosses));
            }
        }
        write_plot(context, context.step_name, rates);
        write_plot(context, context.step_name + "_viscosity", viscosities);
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
