#include "workflows/jamming_report.h"

#include "engine/value.h"
#include "io/atomic_file.h"
#include "workflows/averages.h"

#include <cmath>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::ordered_json;

/// A volume fraction over its starts.
struct Summary {
    double volume_fraction = 0;
    int starts = 0, unpacked = 0;          // without a packing
    int jam = 0, always = 0;               // that jam at all; at the lowest stress already
    int unjam = 0, reverse = 0;            // that flow again
    std::vector<JammingBracket> brackets;  // with two ends
    Value stress;                          // if there are any
};

std::vector<Summary> summaries_of(const std::vector<Found>& all)
{
    std::vector<Summary> result;
    for (const Found& f : all) {
        if (result.empty() || result.back().volume_fraction != f.volume_fraction)
            result.push_back({.volume_fraction = f.volume_fraction, .brackets = {}, .stress = {}});
        Summary& s = result.back();
        ++s.starts;
        s.unpacked += !f.is_packed;
        if (!f.is_packed) continue;
        s.jam += f.has_jammed;
        s.always += f.bracket.flows == 0;
        s.unjam += f.has_jammed && f.unjamming.outcome == Outcome::flowing;
        s.reverse += f.has_jammed && f.reversal.outcome == Outcome::flowing;
        if (f.bracket.flows > 0 && f.bracket.jams > 0) s.brackets.push_back(f.bracket);
    }
    for (Summary& s : result) {
        if (s.brackets.empty()) continue;
        s.stress = jamming_stress(s.brackets);
    }
    return result;
}

std::string csv_text(const std::vector<Found>& all)
{
    std::string text =
        "# each stress that was tried; flows_up_to, jams_from: the bracket of the start (0: not "
        "known); viscosity [eta0] and force residual: of the last window\n"
        "volume_fraction,seed,flows_up_to,jams_from,test,stress,outcome,strain,viscosity,"
        "force_residual,steps\n";
    for (const Found& f : all) {
        const auto row = [&](const char* test, const Tried& t) {
            text += io::number_text(f.volume_fraction) + "," + std::to_string(f.seed) + "," +
                    io::number_text(f.bracket.flows) + "," + io::number_text(f.bracket.jams) + "," +
                    test + "," + io::number_text(t.stress) + "," +
                    std::string(outcome_name(t.outcome)) + "," + io::number_text(t.strain) + "," +
                    io::number_text(t.viscosity) + "," + io::number_text(t.force_residual) + "," +
                    std::to_string(t.steps) + "\n";
        };
        for (const Tried& t : f.tried) row("bisection", t);
        if (!f.has_jammed) continue;
        row("unjamming", f.unjamming);
        row("reversal", f.reversal);
    }
    return text;
}

render::Plot plot_of(const std::vector<Found>& all, const std::vector<Summary>& summaries,
                     const JammingSearch& search, const PictureSize& size)
{
    render::Plot plot = size.plot();
    plot.title =
        "Stress above which the suspension jams, $n$ = " + std::to_string(search.particles);
    plot.x.title = "volume fraction $ϕ$";
    plot.y.title = "shear stress $σ$/$σ$_{0}";
    plot.y.logarithmic = true;
    plot.y.minimum = search.lowest_stress / 1.3;
    plot.y.maximum = search.highest_stress * 1.3;
    render::Series flowing, jammed, mean;
    flowing.label = "flows";
    jammed.label = "jams";
    flowing.marker = render::Marker::circle;
    flowing.open_marker = true;
    jammed.marker = render::Marker::cross;
    for (const Found& f : all)
        for (const Tried& t : f.tried) {
            render::Series& series = t.outcome == Outcome::flowing ? flowing : jammed;
            series.x.push_back(f.volume_fraction);
            series.y.push_back(t.stress);
        }
    flowing.line = jammed.line = render::Line::none;
    mean.label = "mean over the starts";
    mean.line = render::Line::dashed;
    for (const Summary& s : summaries) {
        if (s.brackets.empty()) continue;
        mean.x.push_back(s.volume_fraction);
        mean.y.push_back(s.stress.mean);
        mean.y_error.push_back(s.stress.standard_error);
    }
    for (render::Series* series : {&flowing, &jammed, &mean})
        if (!series->x.empty()) plot.series.push_back(std::move(*series));
    return plot;
}

void report(Context& context, const std::vector<Summary>& summaries)
{
    bool jams = false, all_flow_again = true;
    auto& list = context.results["volume_fractions"] = Json::array();
    for (const Summary& s : summaries) {
        jams |= s.jam > 0;
        all_flow_again &= s.unjam == s.jam;
        Json json{{"volume_fraction", s.volume_fraction}, {"starts", s.starts},
                  {"without_packing", s.unpacked},        {"jam", s.jam},
                  {"jam_at_the_lowest", s.always},        {"flow_again_at_the_lowest", s.unjam},
                  {"flow_in_reverse", s.reverse}};
        if (!s.brackets.empty()) json["jamming_stress"] = quantity_json(s.stress, "sigma0");
        list.push_back(std::move(json));
    }
    context.results["outcome"] = !jams ? "flows at all stresses"
                                 : all_flow_again
                                     ? "jams, and flows again at the lowest stress"
                                     : "jams, and not all flow again at the lowest stress";
}

}

void report_jamming(Context& context, const std::vector<Found>& all, const JammingSearch& search,
                    const PictureSize& size)
{
    const std::vector<Summary> summaries = summaries_of(all);
    io::write_file(context.folder.file(context.step_name + ".csv"), csv_text(all));
    report(context, summaries);
    write_plot(context, context.step_name, plot_of(all, summaries, search, size));
}

}
