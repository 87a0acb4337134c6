// Step "compare": do runs at one volume fraction and stress (or rate) differ, e.g. by a choice of
// the model?
#include "engine/difference.h"
#include "io/atomic_file.h"
#include "workflows/averages.h"
#include "workflows/pictures.h"
#include "workflows/steps.h"

#include <algorithm>
#include <array>
#include <iterator>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::ordered_json;

// What is compared; the viscosity follows from stress and rate.
constexpr std::array compared{"shear_rate",
                              "shear_stress",
                              "contact_number",
                              "frictional_contact_number",
                              "sliding_fraction",
                              "normal_stress_difference_1",
                              "normal_stress_difference_2",
                              "particle_pressure",
                              "mean_nonaffine_speed"};

struct Mean {
    const Run* run;
    std::vector<Estimate> of;  // compared
};

/// What is imposed is exact.
Estimate mean_of(const Run& run, const std::string& name)
{
    const auto* stress = std::get_if<ImposedStress>(&run.control);
    const auto* rate = std::get_if<ImposedRate>(&run.control);
    if (stress && name == "shear_stress") return {.mean = stress->value};
    if (rate && name == "shear_rate") return {.mean = rate->value};
    return estimate_mean(column(stationary_part(run), field_named(name).value));
}

struct Compare {
    double confidence = 0.95;
    PictureSize size;
    std::vector<std::string> runs;  // known when the step is validated

    void describe(io::Fields& f)
    {
        f("confidence", confidence, io::between(0.5, 0.999999), "-",
          "with which all differences that are reported are real");
        size.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        runs = runs_like_the_last(plan);
        if (runs.size() < 2)
            throw node.error(
                "needs two steps \"shear\" before it at the same volume fraction and the same "
                "stress or rate");
        plan.needs.plotted_pixels = size.pixels();
    }

    std::string csv_text(const std::vector<Mean>& means) const
    {
        std::string text =
            "# means after the start-up, and their differences from the first run in standard "
            "errors\nrun";
        for (const char* name : compared)
            text += std::string(",") + name + "," + name + "_error," + name + "_difference";
        for (const Mean& mean : means) {
            text += "\n" + mean.run->name;
            for (std::size_t k = 0; k < compared.size(); ++k)
                for (double value : {mean.of[k].mean, mean.of[k].standard_error,
                                     difference(means.front().of[k], mean.of[k], 1).in_errors})
                    text += "," + io::number_text(value);
        }
        return text + "\n";
    }

    render::Plot plot(const std::vector<Mean>& means) const
    {
        render::Plot plot = size.plot();
        const Run& first = *means.front().run;
        const auto& shown = std::holds_alternative<ImposedRate>(first.control)
                                ? field_named("shear_stress")
                                : field_named("shear_rate");
        plot.title = title_text(first.volume_fraction, first.control, first.particles);
        plot.x.title = axis_text(field_named("strain"));
        plot.y.title = axis_text(shown);
        for (const Mean& mean : means) {
            render::Series series;
            series.label = mean.run->name;
            series.x = column(mean.run->series, &Sample::strain);
            series.y = column(mean.run->series, shown.value);
            series.line_width = 1.6;
            plot.series.push_back(std::move(series));
        }
        return plot;
    }

    void report(Context& context, const std::vector<Mean>& means) const
    {
        const int comparisons = static_cast<int>((means.size() - 1) * compared.size());
        std::string differing;
        context.results["reference"] = means.front().run->name;
        for (auto mean = means.begin() + 1; mean != means.end(); ++mean) {
            Json& json = context.results["differences"][mean->run->name] = Json::object();
            std::string list;
            for (std::size_t k = 0; k < compared.size(); ++k) {
                const Difference d =
                    difference(means.front().of[k], mean->of[k], comparisons, confidence);
                json[compared[k]] = {{"mean", d.mean},
                                     {"standard_error", d.standard_error},
                                     {"unit", field_named(compared[k]).unit},
                                     {"significant", d.significant}};
                if (d.significant) list += (list.empty() ? "" : ", ") + std::string(compared[k]);
            }
            if (!list.empty())
                differing += (differing.empty() ? "" : "; ") + mean->run->name + ": " + list;
        }
        context.results["outcome"] =
            differing.empty() ? "no significant difference" : "different in " + differing;
    }

    void run(Context& context) const
    {
        std::vector<Mean> means;
        Json jammed = Json::array();
        for (const std::string& name : runs) {
            const Run& run = context.run(name);
            if (run.jammed) jammed.push_back(name);
            if (run.jammed || run.series.empty()) continue;
            Mean mean{&run, {}};
            for (const char* one : compared) mean.of.push_back(mean_of(run, one));
            means.push_back(std::move(mean));
        }
        context.results["jammed"] = std::move(jammed);
        if (means.size() < 2) {
            context.results["outcome"] = "nothing to compare, fewer than two runs flow";
            return;
        }
        io::write_file(context.folder.file(context.step_name + ".csv"), csv_text(means));
        report(context, means);
        write_plot(context, context.step_name, plot(means));
    }
};

}

StepKind compare_step()
{
    return step_kind<Compare>("compare", "which means of runs at one stress or rate differ");
}

}
