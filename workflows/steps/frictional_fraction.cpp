// Step "frictional_fraction": how many of the close pairs touch, against the stress, with the law
// of the Wyart-Cates model fitted.
#include "engine/contact_network.h"
#include "engine/friction_law.h"
#include "io/atomic_file.h"
#include "workflows/averages.h"
#include "workflows/measured_curves.h"
#include "workflows/pictures.h"
#include "workflows/steps.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::ordered_json;

struct Shares {
    std::vector<FrictionPoint> points;
    std::optional<FrictionLaw> law;
};

struct FrictionalFraction {
    double close_gap = 0.1;
    PictureSize size;
    std::vector<PlannedRun> runs;  // of steps "shear", known when the step is validated

    void describe(io::Fields& f)
    {
        f("close_gap", close_gap, io::between(1e-6, 10), "a",
          "pairs whose surfaces are nearer are close");
        size.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        runs = runs_for_curves(node, plan);
        for (const PlannedRun& run : runs)
            plan.needs.frames_read = std::max(plan.needs.frames_read, run.frames);
        plan.needs.plotted_pixels = size.pixels();
    }

    /// Frames are few: their scatter counts where it exceeds that of independent particles.
    std::optional<FrictionPoint> point_of(const Run& run) const
    {
        const auto* stress = std::get_if<ImposedStress>(&run.control);
        if (!stress || run.jammed) return std::nullopt;
        std::vector<double> fractions;
        for (const Frame& frame : io::read_run(run.file).frames)
            if (frame.state.strain >= run.start_up.value_or(0) - 1e-9)
                fractions.push_back(
                    contact_network(frame, {.close_gap = close_gap}).frictional_pair_fraction);
        if (fractions.empty()) return std::nullopt;
        const Estimate mean = estimate_mean(fractions);
        const double n = static_cast<double>(run.particles) * static_cast<double>(fractions.size());
        const double independent = std::sqrt(mean.mean * (1 - mean.mean) / n);
        return FrictionPoint{stress->value, mean.mean,
                             std::max({mean.standard_error, independent, 1 / n})};
    }

    std::map<double, Shares> curves_of_runs(const Context& context) const
    {
        std::map<double, Shares> curves;
        for (const PlannedRun& run : runs)
            if (const auto point = point_of(context.run(run.name)))
                curves[run.volume_fraction].points.push_back(*point);
        for (auto& [volume_fraction, curve] : curves) {
            const auto touches = [](const FrictionPoint& p) { return p.fraction > 0; };
            if (std::count_if(curve.points.begin(), curve.points.end(), touches) < 3) continue;
            curve.law = fit_friction_law(curve.points);
        }
        return curves;
    }

    static std::string csv_text(const std::map<double, Shares>& curves)
    {
        std::string text =
            "# fraction: frictional contacts over close pairs; fitted: share exp(-onset/stress)\n"
            "volume_fraction,stress,fraction,fraction_error,fitted";
        for (const auto& [volume_fraction, curve] : curves)
            for (const FrictionPoint& p : curve.points) {
                text += "\n" + io::number_text(volume_fraction);
                for (double value : {p.stress, p.fraction, p.standard_error})
                    text += "," + io::number_text(value);
                text += "," + (curve.law ? io::number_text(curve.law->fraction(p.stress)) : "");
            }
        return text + "\n";
    }

    render::Plot plot(const std::map<double, Shares>& curves) const
    {
        render::Plot plot = size.plot();
        plot.x.title = "shear stress $σ$/$σ$_{0}";
        plot.y.title = "frictional share of the close pairs";
        plot.x.logarithmic = true;
        plot.y.minimum = 0;
        std::size_t number = 0;
        for (const auto& [volume_fraction, curve] : curves) {
            const render::Colour colour = render::cycle_colour(number++);
            render::Series points, fit;
            points.line = render::Line::none;
            points.marker = render::Marker::circle;
            points.colour = fit.colour = colour;
            for (const FrictionPoint& p : curve.points) {
                points.x.push_back(p.stress);
                points.y.push_back(p.fraction);
                points.y_error.push_back(p.standard_error);
            }
            points.label = "$ϕ$ = " + short_number(volume_fraction);
            if (curve.law) {
                points.label +=
                    ", onset stress " + short_number(curve.law->onset_stress.mean) + " $σ$_{0}";
                const auto [low, high] = std::minmax_element(points.x.begin(), points.x.end());
                constexpr int steps = 100;
                for (int k = 0; k <= steps; ++k) {
                    fit.x.push_back(*low * std::pow(*high / *low, k / 100.));
                    fit.y.push_back(curve.law->fraction(fit.x.back()));
                }
                fit.line_width = 1.5;
                plot.series.push_back(std::move(fit));
            }
            plot.series.push_back(std::move(points));
        }
        return plot;
    }

    void run(Context& context) const
    {
        const std::map<double, Shares> curves = curves_of_runs(context);
        bool fitted = false;
        auto& list = context.results["curves"] = Json::array();
        for (const auto& [volume_fraction, curve] : curves) {
            Json json{{"volume_fraction", volume_fraction}};
            if (curve.law) {
                fitted = true;
                json["onset_stress"] = quantity_json(curve.law->onset_stress, "sigma0");
                json["share_at_high_stress"] = quantity_json(curve.law->share, "-");
                json["chi2_per_degree"] = curve.law->chi2_per_degree;
            }
            list.push_back(std::move(json));
        }
        context.results["outcome"] =
            fitted ? "fitted" : "nothing fitted, three flowing stresses with contacts are needed";
        if (curves.empty()) return;
        io::write_file(context.folder.file(context.step_name + ".csv"), csv_text(curves));
        write_plot(context, context.step_name, plot(curves));
    }
};

}

StepKind frictional_fraction_step()
{
    return step_kind<FrictionalFraction>(
        "frictional_fraction", "share of close pairs that touch, against the stress, and its law");
}

}
