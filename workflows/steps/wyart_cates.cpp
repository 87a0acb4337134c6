// Step "wyart_cates": the model of Wyart & Cates from all runs at imposed stresses before it.
#include "io/atomic_file.h"
#include "workflows/steps.h"
#include "workflows/wyart_cates_fits.h"
#include "workflows/wyart_cates_pictures.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::ordered_json;
using Parameter = WyartCatesParameter;

constexpr std::size_t parameter_count = wyart_cates_parameters.size();

std::string_view unit(Parameter p)
{
    return p == Parameter::onset_stress ? "sigma0" : "-";
}

Json interval_json(const Interval& i)
{
    return {i.lower, i.upper};
}

/// {"mean", "standard_error", "unit", "interval"} of the bootstrap.
Json estimate_json(double value, std::vector<double> drawn, std::string_view unit,
                   double confidence)
{
    double mean = 0, squares = 0;
    for (double x : drawn) mean += x / static_cast<double>(drawn.size());
    for (double x : drawn) squares += (x - mean) * (x - mean) / static_cast<double>(drawn.size());
    Json json = {{"mean", value}, {"standard_error", std::sqrt(squares)}, {"unit", unit}};
    if (!drawn.empty())
        json["interval"] = interval_json(percentile_interval(std::move(drawn), confidence));
    return json;
}

struct WyartCatesStep {
    double exponent = 2, confidence = 0.95;
    std::optional<double> jammed_viscosity;
    int bootstrap_samples = 200;
    std::uint64_t seed = 1;
    PictureSize size;
    std::vector<PlannedRun> runs;  // of steps "shear", known when the step is validated

    void describe(io::Fields& f)
    {
        f("exponent", exponent, io::between(0.5, 10), "-", "of the variants that hold it");
        f("jammed_viscosity", jammed_viscosity, io::between(1, 1e12), "eta0",
          "jammed points are known to have a higher viscosity; default: the highest that flows");
        f("bootstrap_samples", bootstrap_samples, io::Integers{20, 10000}, "-",
          "sets of data drawn for the intervals of each fit");
        f("seed", seed, "of the bootstrap");
        f("confidence", confidence, io::between(0.5, 0.9999), "-", "of each interval");
        size.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        runs = runs_for_curves(node, plan);
        std::set<double> fractions;
        for (const PlannedRun& run : runs)
            if (std::holds_alternative<ImposedStress>(run.control))
                fractions.insert(run.volume_fraction);
        if (fractions.size() < 2)
            throw node.error(
                "needs runs at imposed stresses at two volume fractions at least, there is only " +
                io::number_text(*fractions.begin()));
        plan.needs.plotted_pixels = 2 * size.pixels();
    }

    /// What flows or jams; the rest has no viscosity.
    std::vector<WyartCatesPoint> points_of(const Curves& curves) const
    {
        std::vector<WyartCatesPoint> points;
        for (const auto& [volume_fraction, curve] : curves)
            for (const auto& [stress, m] : curve.by_stress) {
                if (flows(m))
                    points.push_back({volume_fraction, stress, m.viscosity(),
                                      m.viscosity_error() / m.viscosity(), false});
                else if (m.jammed)
                    points.push_back({volume_fraction, stress, 0, 0, true});
            }
        const double bound = jammed_viscosity.value_or(lower_bound(points));
        for (WyartCatesPoint& p : points)
            if (p.jammed) p.viscosity = bound;
        return points;
    }

    std::vector<WyartCatesVariant> variants() const
    {
        return {{exponent, 1}, {{}, 1}, {exponent, {}}, {{}, {}}};
    }

    std::vector<Row> rows_of(const std::vector<WyartCatesPoint>& all) const
    {
        std::vector<Row> rows;
        const std::vector<FitRange> ranges = fit_ranges(all);
        for (std::size_t r = 0; r < ranges.size(); ++r) {
            const std::vector<WyartCatesPoint> points = points_in(ranges[r], all);
            for (const WyartCatesVariant& variant : variants()) {
                if (!reason_not_to_fit(points, variant).empty()) continue;
                Row row{ranges[r], variant, fit_wyart_cates(points, variant)};
                row.drawn =
                    bootstrap_wyart_cates(points, variant, row.fit, bootstrap_samples, seed);
                for (std::size_t k = 0; k < parameter_count && r == 0; ++k)
                    if (is_free(variant, wyart_cates_parameters[k]))
                        row.profile[k] = profile_interval(points, variant, row.fit,
                                                          wyart_cates_parameters[k], confidence);
                rows.push_back(std::move(row));
            }
        }
        return rows;
    }

    void write_best(Context& context, const Row& best, const Curves& curves) const
    {
        Json& results = context.results;
        for (std::size_t k = 0; k < parameter_count; ++k) {
            const Parameter p = wyart_cates_parameters[k];
            Json& json = results[std::string(parameter_name(p))];
            const double value = value_of(best.fit.model, p);
            json = is_free(best.variant, p)
                       ? estimate_json(value, best.drawn_values(p), unit(p), confidence)
                       : Json{{"mean", value}, {"held", true}, {"unit", unit(p)}};
            if (const auto& i = best.profile[k]) json["profile_interval"] = interval_json(*i);
        }
        results["scatter"] = best.fit.scatter;
        results["rms"] = best.fit.rms;
        if (const auto critical = critical_point(best.fit.model)) {
            results["critical_fraction"] = estimate_json(
                critical->volume_fraction, best.drawn_values(critical_fraction), "-", confidence);
            results["critical_stress"] = critical->stress;
            results["critical_shear_rate"] = critical->shear_rate;
        }
        for (const auto& [volume_fraction, curve] : curves) {
            const double stress = largest_stress(best.fit.model, volume_fraction);
            const CurveShape shape = model_shape(best.fit.model, volume_fraction);
            const auto same = std::count_if(best.drawn.begin(), best.drawn.end(),
                                            [&, phi = volume_fraction](const WyartCates& m) {
                                                return model_shape(m, phi) == shape;
                                            });
            Json json = {{"volume_fraction", volume_fraction},
                         {"shape", shape_name(shape)},
                         {"share_of_bootstrap", double(same) / bootstrap_samples}};
            if (std::isfinite(stress)) json["largest_stress"] = stress;
            results["shapes"].push_back(std::move(json));
        }
    }

    void run(Context& context) const
    {
        const Curves curves = curves_of(context, runs);
        const std::vector<WyartCatesPoint> points = points_of(curves);
        std::size_t measured = 0;
        for (const auto& [volume_fraction, curve] : curves) measured += curve.by_stress.size();
        context.results["points_left_out"] = measured - points.size();
        context.results["jammed_viscosity"] = jammed_viscosity.value_or(lower_bound(points));
        context.results["confidence"] = confidence;
        const std::vector<Row> rows = rows_of(points);
        io::write_file(context.folder.file(context.step_name + ".csv"), csv_text(rows, confidence));
        const std::string reason = reason_not_to_fit(points, variants().front());
        if (!reason.empty()) {
            context.results["outcome"] = "nothing fitted: " + reason;
            return;
        }
        const auto widest_end = std::find_if(
            rows.begin(), rows.end(), [](const Row& row) { return !row.profile[0].has_value(); });
        const Row& best = *std::min_element(
            rows.begin(), widest_end,
            [](const Row& a, const Row& b) { return a.fit.akaike < b.fit.akaike; });
        write_best(context, best, curves);
        for (auto row = rows.begin(); row != widest_end; ++row)
            context.results["variants"].push_back(
                {{"variant", words(row->variant)},
                 {"akaike_above_lowest", row->fit.akaike - best.fit.akaike},
                 {"rms", row->fit.rms}});
        context.results["outcome"] = "fitted, " + words(best.variant);
        context.results["verdict"] = verdict(rows, best, points, confidence);
        write_plot(context, context.step_name, sketch_plot(curves, best.fit.model, size));
        write_plot(context, context.step_name + "_map",
                   state_map_plot(curves, best.fit.model, best.drawn, confidence, size));
    }
};

}

StepKind wyart_cates_step()
{
    return step_kind<WyartCatesStep>("wyart_cates",
                                     "two jamming fractions and the onset stress fitted to all "
                                     "flow curves, with the map of flow states");
}

}
