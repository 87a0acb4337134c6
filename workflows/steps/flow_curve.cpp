// Step "flow_curve": shear rate against shear stress from all stress-controlled runs before it.
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

/// A point of a flow curve and the run behind it.
struct Measured {
    const Run* run = nullptr;
    FlowPoint point;
    Estimate contact_number;
};

/// Points by stress, for each volume fraction as it was asked for.
using Curves = std::map<double, std::vector<Measured>>;

Measured measured(const Run& run, double stress)
{
    const std::span<const Sample> samples = stationary_part(run);
    const Estimate rate = estimate_mean(column(samples, &Sample::shear_rate));
    FlowPoint point{.stress = stress,
                    .shear_rate = run.jammed ? 0 : rate.mean,
                    .standard_error = run.jammed ? 0 : rate.standard_error,
                    .jammed = run.jammed};
    return {&run, point, estimate_mean(column(samples, &Sample::contact_number))};
}

/// Of two runs at one stress the later one counts.
Curves curves_of(const Context& context, const std::vector<PlannedRun>& planned)
{
    Curves curves;
    for (const PlannedRun& one : planned) {
        const double stress = std::get<ImposedStress>(one.control).value;
        auto& curve = curves[one.volume_fraction];
        std::erase_if(curve, [&](const Measured& m) { return m.point.stress == stress; });
        curve.push_back(measured(context.run(one.name), stress));
    }
    for (auto& [volume_fraction, curve] : curves)
        std::sort(curve.begin(), curve.end(), [](const Measured& a, const Measured& b) {
            return a.point.stress < b.point.stress;
        });
    return curves;
}

std::string csv_text(const Curves& curves)
{
    std::string text =
        "# stress [sigma0], shear_rate [rate0], viscosity [eta0]; errors are standard errors\n"
        "volume_fraction,stress,shear_rate,shear_rate_error,viscosity,viscosity_error,"
        "contact_number,outcome,run\n";
    for (const auto& [volume_fraction, curve] : curves)
        for (const auto& [run, point, contacts] : curve) {
            const double viscosity = point.stress / point.shear_rate;
            const double error = viscosity * point.standard_error / std::abs(point.shear_rate);
            text += io::number_text(volume_fraction);
            const auto add = [&](double value) {
                text += ',';
                if (std::isfinite(value)) text += io::number_text(value);  // jammed: empty
            };
            add(point.stress);
            add(point.shear_rate);
            add(point.standard_error);
            add(viscosity);
            add(error);
            add(contacts.mean);
            text += (point.jammed ? ",jammed," : ",flowing,") + run->name + "\n";
        }
    return text;
}

std::string label(double volume_fraction, const CurveAnalysis& analysis)
{
    std::string text =
        "$ϕ$ = " + short_number(volume_fraction) + ", " + std::string(shape_name(analysis.shape));
    if (analysis.jams) text += ", jams at $σ$/$σ$_{0} = " + short_number(analysis.jamming_stress);
    return text;
}

render::Series empty_series(const std::string& label)
{
    render::Series series;
    series.label = label;
    series.marker = render::Marker::circle;
    return series;
}

struct FlowCurve {
    double confidence = 0.95;
    PictureSize size;
    std::vector<PlannedRun> runs;  // under an imposed stress, known when the step is validated

    void describe(io::Fields& f)
    {
        f("confidence", confidence, io::between(0.5, 0.9999), "-",
          "of all statements on one curve together");
        size.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        std::map<double, std::vector<double>> stresses;  // by volume fraction
        for (const PlannedRun& run : plan.runs)
            if (const auto* stress = std::get_if<ImposedStress>(&run.control))
                if (run.frames > 0) {  // a step "shear"
                    stresses[run.volume_fraction].push_back(stress->value);
                    runs.push_back(run);
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

    static Json curve_json(double volume_fraction, const CurveAnalysis& analysis)
    {
        Json json = {{"volume_fraction", volume_fraction},
                     {"shape", shape_name(analysis.shape)},
                     {"slopes", Json::array()}};
        if (analysis.jams) json["jamming_stress"] = analysis.jamming_stress;
        static constexpr const char* trends[] = {"rises", "falls", "unknown"};
        for (const Slope& s : analysis.slopes)
            json["slopes"].push_back({{"from_stress", s.from},
                                      {"to_stress", s.to},
                                      {"slope", s.slope},
                                      {"confidence_interval", {s.lower, s.upper}},
                                      {"trend", trends[static_cast<int>(s.trend)]}});
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
        for (const auto& [volume_fraction, curve] : curves) {
            std::vector<FlowPoint> points;
            for (const Measured& m : curve) points.push_back(m.point);
            const CurveAnalysis analysis = analyse_flow_curve(points, confidence);
            list.push_back(curve_json(volume_fraction, analysis));
            render::Series rate = empty_series(label(volume_fraction, analysis));
            render::Series viscosity = empty_series("$ϕ$ = " + short_number(volume_fraction));
            for (const FlowPoint& p : points) {
                if (p.jammed || !(p.shear_rate > 0)) continue;  // no place on logarithmic axes
                rate.x.push_back(p.stress);
                rate.y.push_back(p.shear_rate);
                rate.y_error.push_back(p.standard_error);
                viscosity.x.push_back(p.shear_rate);
                viscosity.x_error.push_back(p.standard_error);
                viscosity.y.push_back(p.stress / p.shear_rate);
                viscosity.y_error.push_back(p.stress * p.standard_error /
                                            (p.shear_rate * p.shear_rate));
            }
            rates.series.push_back(std::move(rate));
            viscosities.series.push_back(std::move(viscosity));
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
