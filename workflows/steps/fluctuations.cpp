// Step "fluctuations": how much a scalar fluctuates in runs with different numbers of particles
// (Mari et al., Phys. Rev. E 91, 052302, 2015, Fig. 4).
#include "engine/fluctuations.h"
#include "io/atomic_file.h"
#include "workflows/averages.h"
#include "workflows/pictures.h"
#include "workflows/report.h"
#include "workflows/steps.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::ordered_json;

struct Fluctuating {
    const Run* run;
    Fluctuations of;

    /// Of the scalar over its mean: what sizes have in common.
    double relative() const { return of.variance / (of.mean.mean * of.mean.mean); }
    double relative_error() const
    {
        const double variance = of.variance_error / of.variance;
        const double mean = 2 * of.mean.standard_error / of.mean.mean;
        return relative() * std::hypot(variance, mean);
    }
    bool is_fitted() const { return of.variance > 0 && of.variance_error > 0; }
};

struct Law {
    PowerLaw variance;
    double least = 0, most = 0;  // particles
};

struct FluctuationsStep {
    static constexpr double largest_exponent_error = 0.3;
    static constexpr double largest_kurtosis = 3;  // excess; 6 for exponentially rare excursions

    std::string y = "shear_rate";
    std::optional<double> from_strain;
    PictureSize size;
    std::vector<std::string> runs;  // known when the step is validated

    void describe(io::Fields& f)
    {
        f("y", y, field_names(), "scalar of the time series");
        f("from_strain", from_strain, io::between(0, 1e4), "-",
          "strain from which on the series count; default: where the start-up of each run ends");
        size.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        runs = runs_like_the_last(plan);
        if (runs.empty()) throw node.error("needs a run: put a step \"shear\" before it");
        plan.needs.plotted_pixels = size.pixels();
        plan.endings = {"", "_variance"};
    }

    std::span<const Sample> counted(const Run& run) const
    {
        return from_strain ? samples_from(run, *from_strain) : stationary_part(run);
    }

    std::string csv_text(const std::vector<Fluctuating>& all) const
    {
        std::string text = "# " + y +
                           " after the start-up: mean, variance, skewness, excess kurtosis, with "
                           "standard errors\nrun,particles,samples,effective_samples,mean,"
                           "mean_error,variance,variance_error,relative_variance,"
                           "relative_variance_error,skewness,skewness_error,kurtosis,"
                           "kurtosis_error";
        for (const Fluctuating& one : all) {
            const Fluctuations& f = one.of;
            text += "\n" + one.run->name + "," + std::to_string(one.run->particles) + "," +
                    std::to_string(f.mean.used);
            for (double value : {f.mean.effective_samples, f.mean.mean, f.mean.standard_error,
                                 f.variance, f.variance_error, one.relative(), one.relative_error(),
                                 f.skewness, f.skewness_error, f.kurtosis, f.kurtosis_error})
                text += "," + io::number_text(value);
        }
        return text + "\n";
    }

    render::Plot series_plot(const std::vector<Fluctuating>& all) const
    {
        render::Plot plot = size.plot();
        const Run& last = *all.back().run;
        plot.title = title_text(last.volume_fraction, last.control, last.particles);
        plot.title.erase(plot.title.rfind(", $n$"));
        plot.x.title = axis_text(field_named("strain"));
        plot.y.title = axis_text(field_named(y));
        for (const Fluctuating& one : all) {
            render::Series series;
            series.label = "$n$ = " + std::to_string(one.run->particles);
            series.x = column(counted(*one.run), &Sample::strain);
            series.y = column(counted(*one.run), field_named(y).value);
            series.line_width = 1.6;
            plot.series.push_back(std::move(series));
        }
        return plot;
    }

    render::Plot variance_plot(const std::vector<Fluctuating>& all, const Law* law) const
    {
        render::Plot plot = size.plot();
        plot.title = "Variance of the " + axis_text(field_named(y)) + " over its mean squared";
        plot.x.title = "particles $n$";
        plot.y.title = "variance/mean^{2}";
        plot.x.logarithmic = plot.y.logarithmic = true;
        render::Series points;
        points.label = "runs";
        points.line = render::Line::none;
        points.marker = render::Marker::circle;
        for (const Fluctuating& one : all) {
            if (!one.is_fitted()) continue;
            points.x.push_back(one.run->particles);
            points.y.push_back(one.relative());
            points.y_error.push_back(one.relative_error());
        }
        if (law) {
            render::Series line;
            line.label = "$n$^{" +
                         with_error(law->variance.exponent, law->variance.exponent_error, " ± ") +
                         "}";
            for (double n : {law->least, law->most}) {
                line.x.push_back(n);
                line.y.push_back(law->variance.amplitude * std::pow(n, law->variance.exponent));
            }
            line.line = render::Line::dashed;
            plot.series.push_back(std::move(line));
        }
        plot.series.push_back(std::move(points));
        return plot;
    }

    std::optional<Law> law_of(const std::vector<Fluctuating>& all) const
    {
        std::vector<double> n, variance, error;
        for (const Fluctuating& one : all) {
            if (!one.is_fitted()) continue;
            n.push_back(one.run->particles);
            variance.push_back(one.relative());
            error.push_back(one.relative_error());
        }
        if (n.empty()) return std::nullopt;
        const auto [least, most] = std::minmax_element(n.begin(), n.end());
        if (*least == *most) return std::nullopt;
        return Law{fit_power_law(n, variance, error), *least, *most};
    }

    void report(Context& context, const std::vector<Fluctuating>& all, const Law* law) const
    {
        bool intermittent = false;
        context.results["runs"] = Json::array();
        for (const Fluctuating& one : all) {
            const Fluctuations& f = one.of;
            intermittent |= f.kurtosis - 3 * f.kurtosis_error > largest_kurtosis;
            context.results["runs"].push_back(
                {{"run", one.run->name},
                 {"particles", one.run->particles},
                 {"relative_variance", quantity_json(one.relative(), one.relative_error(), "-")},
                 {"skewness", quantity_json(f.skewness, f.skewness_error, "-")},
                 {"kurtosis", quantity_json(f.kurtosis, f.kurtosis_error, "-")}});
        }
        std::string outcome = intermittent ? "rare large excursions" : "no rare large excursions";
        if (law) {
            const PowerLaw& fit = law->variance;
            context.results["exponent"] = quantity_json(fit.exponent, fit.exponent_error, "-");
            context.results["chi2_per_degree"] = fit.chi2_per_degree;
            const double distance = std::abs(fit.exponent + 1) / fit.exponent_error;
            if (fit.exponent_error > largest_exponent_error)
                outcome += "; how the variance falls with n is undecided";
            else if (distance < 2)
                outcome += "; the variance falls as 1/n within two errors";
            else
                outcome +=
                    "; the variance does not fall as 1/n, by " + short_number(distance) + " errors";
        }
        context.results["outcome"] = outcome;
    }

    void run(Context& context) const
    {
        std::vector<Fluctuating> all;
        for (const std::string& name : runs) {
            const Run& run = context.run(name);
            const std::span<const Sample> samples = counted(run);
            if (run.jammed || samples.size() < 10) continue;
            Fluctuating one{&run, fluctuations(column(samples, field_named(y).value))};
            if (one.of.mean.mean != 0) all.push_back(std::move(one));
        }
        if (all.empty()) {
            context.results["outcome"] = "nothing to say, all runs are jammed or too short";
            return;
        }
        std::stable_sort(all.begin(), all.end(), [](const Fluctuating& a, const Fluctuating& b) {
            return a.run->particles < b.run->particles;
        });
        const std::optional<Law> law = law_of(all);
        io::write_file(context.folder.file(context.step_name + ".csv"), csv_text(all));
        report(context, all, law ? &*law : nullptr);
        write_plot(context, context.step_name, series_plot(all));
        if (std::any_of(all.begin(), all.end(), [](const auto& one) { return one.is_fitted(); }))
            write_plot(context, context.step_name + "_variance",
                       variance_plot(all, law ? &*law : nullptr));
    }
};

}

StepKind fluctuations_step()
{
    return step_kind<FluctuationsStep>(
        "fluctuations", "variance of a scalar against the number of particles, with its exponent");
}

}
