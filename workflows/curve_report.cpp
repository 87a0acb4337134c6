#include "workflows/curve_report.h"

#include "engine/flow_curve.h"
#include "io/atomic_file.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::ordered_json;

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
    // what is imposed has no error bars
    for (auto* errors : {&series.x_error, &series.y_error})
        if (std::all_of(errors->begin(), errors->end(), [](double e) { return e == 0; }))
            errors->clear();
    return series;
}

/// Rising curves leave no corner free for a long legend: room above them for its lines.
void make_room(render::Plot& plot)
{
    double highest = 0;
    for (const render::Series& series : plot.series)
        for (double y : series.y) highest = std::max(highest, y);
    if (highest > 0)
        plot.y.maximum = highest * std::pow(10, 0.15 * static_cast<double>(plot.series.size()));
}

Json slope_json(const Slope& s)
{
    static constexpr const char* trends[] = {"rises", "falls", "unknown"};
    return {{"from_stress", s.from},
            {"to_stress", s.to},
            {"slope", s.slope},
            {"confidence_interval", {s.lower, s.upper}},
            {"trend", trends[static_cast<int>(s.trend)]}};
}

Json curve_json(double volume_fraction, const CurveAnalysis& analysis)
{
    Json json = {{"volume_fraction", volume_fraction}, {"shape", shape_name(analysis.shape)}};
    if (analysis.jams) json["jamming_stress"] = analysis.jamming_stress;
    if (analysis.fall) json["most_certain_fall"] = slope_json(*analysis.fall);
    for (const Slope& s : analysis.slopes) json["slopes"].push_back(slope_json(s));
    return json;
}

render::Plot empty_plot(const PictureSize& size, const char* title)
{
    render::Plot plot = size.plot();
    plot.title = title;
    plot.x.logarithmic = plot.y.logarithmic = true;
    return plot;
}

}

void report_curves(Context& context, const Curves& curves, double confidence,
                   const PictureSize& size)
{
    io::write_file(context.folder.file(context.step_name + ".csv"), csv_text(curves));
    render::Plot rates = empty_plot(size, "Flow curves"),
                 viscosities = empty_plot(size, "Viscosity");
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
    const auto is_empty = [](const render::Series& series) { return series.x.empty(); };
    for (render::Plot* plot : {&rates, &viscosities}) std::erase_if(plot->series, is_empty);
    if (rates.series.empty()) {
        context.results["outcome"] = "no picture, nothing flows";
        return;
    }
    make_room(rates);
    write_plot(context, context.step_name, rates);
    write_plot(context, context.step_name + "_viscosity", viscosities);
}

}
