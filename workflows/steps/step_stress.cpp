// Step "step_stress": what follows a step in the imposed stress, as a mean over many starts (Mari
// et al., Phys. Rev. E 91, 052302, 2015, Fig. 5).
//
// Each start packs with a seed of its own, shears at the stress before, and then at the stress
// after. Starts are parts: they are computed side by side, and an interrupted step goes on with
// those that are missing.
#include "engine/archive.h"
#include "engine/ensemble.h"
#include "engine/memory_kernel.h"
#include "engine/random.h"
#include "io/atomic_file.h"
#include "workflows/averages.h"
#include "workflows/parts.h"
#include "workflows/pictures.h"
#include "workflows/shearing.h"
#include "workflows/start.h"
#include "workflows/steps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::ordered_json;
using Columns = std::vector<std::vector<double>>;  // [starts][strains]

enum class StiffnessRule { rescaled, kept };

/// One start.
struct Response {
    std::uint64_t seed = 0;
    bool jammed = false;  // before or after the step, or out of time
    std::vector<Sample> before, after;
};

template <class Archive>
void archive(Archive& a, Response& r)
{
    a(r.seed, r.jammed, r.before, r.after);
}

/// What is drawn, fitted and written.
struct Quantity {
    std::string name, axis;
    EnsembleMean before, after;
    Columns members;  // after the step
};

std::vector<std::vector<double>> columns(const std::vector<Response>& responses,
                                         std::vector<Sample> Response::*part, double Sample::*value)
{
    Columns result;
    for (const Response& response : responses) result.push_back(column(response.*part, value));
    return result;
}

/// Viscosities of the members are pseudo-values of the ratio (the jackknife's first order), whose
/// mean is the ratio of the means.
Columns ratio_members(const Columns& stress, const Columns& rate)
{
    const EnsembleMean ratio = ensemble_ratio(stress, rate), mean_rate = ensemble_mean(rate);
    Columns result = stress;
    for (std::size_t i = 0; i < result.size(); ++i)
        for (std::size_t k = 0; k < result[i].size(); ++k)
            result[i][k] =
                ratio.mean[k] + (stress[i][k] - ratio.mean[k] * rate[i][k]) / mean_rate.mean[k];
    return result;
}

std::vector<Quantity> quantities_of(const std::vector<Response>& responses)
{
    std::vector<Quantity> result;
    const auto of = [&](std::vector<Sample> Response::*part, double Sample::*value) {
        return columns(responses, part, value);
    };
    for (const SampleField& field : sample_fields()) {
        if (field.name == "strain" || field.name == "time") continue;
        Quantity q{std::string(field.name), axis_text(field), {}, {}, {}};
        if (field.name == "viscosity") {
            q.members = ratio_members(of(&Response::after, &Sample::shear_stress),
                                      of(&Response::after, &Sample::shear_rate));
            q.before = ensemble_ratio(of(&Response::before, &Sample::shear_stress),
                                      of(&Response::before, &Sample::shear_rate));
        } else {
            q.members = of(&Response::after, field.value);
            q.before = ensemble_mean(of(&Response::before, field.value));
        }
        q.after = ensemble_mean(q.members);
        result.push_back(std::move(q));
    }
    return result;
}

Json value_json(const Value& value, std::string_view unit)
{
    return {{"mean", value.mean}, {"standard_error", value.standard_error}, {"unit", unit}};
}

Json fit_json(const Relaxation& fit)
{
    Json json{{"exponentials", fit.terms.size()}};
    json["terms"] = Json::array();
    for (const RelaxationTerm& term : fit.terms)
        json["terms"].push_back({{"amplitude", value_json(term.amplitude, "rate0")},
                                 {"relaxation_strain", value_json(term.relaxation_strain, "-")}});
    json["plateau"] = value_json(fit.plateau, "rate0");
    json["chi2_per_degree"] = fit.chi2_per_degree;
    json["aic"] = fit.aic;
    json["resolved"] = fit.resolved;
    return json;
}

struct StepStress {
    Start start;
    double stress_before = 2, stress_after = 3;
    double strain_before = 2, strain_after = 0.4;
    int starts = 100;
    double series_interval = 5e-4, displacement = 5e-3;
    StiffnessRule stiffness = StiffnessRule::rescaled;
    PictureSize size{1440, 720};

    static constexpr double interval_before = 0.005, shown_before = 0.1;

    void describe(io::Fields& f)
    {
        start.describe(f);
        f("starts", starts, io::Integers{2, 100'000}, "-",
          "independent packings, with seeds made from that of the suspension");
        f("stress_before", stress_before, io::between(1e-6, 1e9), "sigma0", "imposed at first");
        f("stress_after", stress_after, io::between(1e-6, 1e9), "sigma0", "imposed then");
        f("strain_before", strain_before, io::above_to(0.1, 1e4), "-",
          "strain of each start before the step in stress");
        f("strain_after", strain_after, io::above_to(0, 1e3), "-", "strain after it");
        f("series_interval", series_interval, io::between(1e-6, 1), "strain",
          "strain between two samples after the step");
        f("displacement", displacement, io::above_to(0, 0.1), "a",
          "nothing moves by more than this in one step");
        f("stiffness", stiffness,
          io::Words<StiffnessRule>{{"rescaled", StiffnessRule::rescaled},
                                   {"kept", StiffnessRule::kept}},
          "the springs of contacts follow the stress at once, or stay those of stress_before "
          "(models with stiffness_scale \"stress\")");
        size.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        Plan own = plan;  // the packings of this step are no state for the next one
        start.check(node, own);
        if (stress_before == stress_after)
            throw node.error_at_key("stress_after", "must differ from stress_before");
        if (strain_after / series_interval > 1e5 || strain_after / series_interval < 10)
            throw node.error_at_key(
                "series_interval",
                "must give 10 to 1e5 samples in the strain " + io::number_text(strain_after));
        const Model& model = plan.suspension.model;
        if (model.stiffness_scale == StiffnessScale::fixed && node.has("stiffness"))
            throw node.error_at_key("stiffness",
                                    "the model's stiffness_scale \"fixed\" leaves no choice");
        if (model.contact_hydrodynamics == ContactHydrodynamics::dashpot)
            throw node.error("needs contact_hydrodynamics \"lubrication\"");
        plan.needs.particles = own.particles;
        plan.needs.volume_fraction = own.volume_fraction;
        plan.needs.samples =
            starts * (strain_after / series_interval + strain_before / interval_before);
        plan.needs.plotted_pixels = size.pixels();
    }

    ShearingTask task(const Model& model, double stress, double strain, double interval) const
    {
        ShearingParameters parameters;
        parameters.stress = stress;
        parameters.displacement = displacement;
        parameters.series_interval = interval;
        return parameters.task(model, strain, 0, 1);
    }

    Model model_after(const Model& model) const
    {
        Model result = model;
        if (stiffness == StiffnessRule::rescaled || model.stiffness_scale == StiffnessScale::fixed)
            return result;
        const Stiffness kept = sigmaflow::stiffness(model, ImposedStress{stress_before});
        result.stiffness_scale = StiffnessScale::fixed;
        result.normal_stiffness = kept.normal;
        result.tangential_stiffness = kept.tangential;
        result.rolling_stiffness = kept.rolling;
        return result;
    }

    Response respond(const Suspension& suspension, int number, const Pulse& pulse) const
    {
        PackingParameters packing = start.packing(suspension);
        constexpr std::uint32_t stream = 0x5354;  // of these seeds
        packing.seed = static_cast<std::uint64_t>(
            uniform(packing.seed, stream, static_cast<std::uint64_t>(number)) * 0x1p53);
        State state = random_packing(packing, [&](int, double) { pulse(); });
        Response response{.seed = packing.seed, .before = {}, .after = {}};
        Trial before = try_shear(
            state, task(suspension.model, stress_before, strain_before, interval_before), pulse);
        response.before = std::move(before.series);
        response.jammed = before.result.outcome != Outcome::flowing;
        if (response.jammed) return response;
        Trial after = try_shear(
            state, task(model_after(suspension.model), stress_after, strain_after, series_interval),
            pulse);
        response.after = std::move(after.series);
        response.jammed = after.result.outcome != Outcome::flowing;
        return response;
    }

    std::vector<Response> respond_all(Context& context) const
    {
        std::vector<Response> result(static_cast<std::size_t>(starts));
        const Parts parts(context);
        compute_side_by_side(context, starts, [&](int k, const Pulse& pulse) {
            const std::string bytes = parts.compute(std::to_string(k), [&] {
                Response response = respond(context.suspension, k, pulse);
                ArchiveWriter a;
                a(response);
                return a.bytes();
            });
            ArchiveReader a(bytes);
            a(result[static_cast<std::size_t>(k)]);
        });
        return result;
    }

    std::string csv_text(const std::vector<double>& before, const std::vector<double>& after,
                         const std::vector<Quantity>& quantities) const
    {
        std::string text =
            "# means over the starts and their standard errors; strain: since the step in stress; "
            "viscosity: stress over mean rate\nstrain";
        for (const Quantity& q : quantities) text += "," + q.name + "," + q.name + "_error";
        const auto add = [&](const std::vector<double>& strains, EnsembleMean Quantity::*part) {
            for (std::size_t k = 0; k < strains.size(); ++k) {
                text += "\n" + io::number_text(strains[k]);
                for (const Quantity& q : quantities)
                    text += "," + io::number_text((q.*part).mean[k]) + "," +
                            io::number_text((q.*part).standard_error[k]);
            }
        };
        add(before, &Quantity::before);
        add(after, &Quantity::after);
        return text + "\n";
    }

    render::Plot plot(const std::vector<double>& before, const std::vector<double>& after,
                      const Quantity& q, const Relaxation* fit) const
    {
        render::Plot plot = size.plot();
        plot.x.title = "strain since the step";
        plot.y.title = q.axis;
        render::Band band;
        render::Series mean;
        const auto add = [&](double strain, double value, double error) {
            if (strain < -shown_before) return;
            mean.x.push_back(strain);
            mean.y.push_back(value);
            band.x.push_back(strain);
            band.lower.push_back(value - error);
            band.upper.push_back(value + error);
        };
        for (std::size_t k = 0; k < before.size(); ++k)
            add(before[k], q.before.mean[k], q.before.standard_error[k]);
        for (std::size_t k = 0; k < after.size(); ++k)
            add(after[k], q.after.mean[k], q.after.standard_error[k]);
        band.label = "standard error";
        band.colour = render::Colour{170, 200, 235};
        mean.label = "mean of " + std::to_string(q.members.size()) + " starts";
        mean.colour = render::Colour{20, 60, 140};
        plot.bands.push_back(std::move(band));
        plot.series.push_back(std::move(mean));
        if (!fit) return plot;
        render::Series curve;
        for (std::size_t k = 1; k < after.size(); ++k) {
            curve.x.push_back(after[k]);
            curve.y.push_back(fit->at(after[k]));
        }
        curve.label = fit->terms.size() == 1 ? "exponential" : "two exponentials";
        curve.line = render::Line::dashed;
        curve.colour = render::Colour{200, 60, 30};
        plot.series.push_back(std::move(curve));
        return plot;
    }

    void fit(Context& context, const std::vector<double>& strain, Quantity& rate,
             std::optional<Relaxation>& best) const
    {
        constexpr int resamples = 200;
        constexpr std::uint64_t seed = 1;
        const Relaxation one = fit_relaxation_of_members(strain, rate.members, 1, resamples, seed);
        const Relaxation two = fit_relaxation_of_members(strain, rate.members, 2, resamples, seed);
        context.results["fits_of_shear_rate"] = Json::array({fit_json(one), fit_json(two)});
        best = better_of(one, two);
        context.results["best_fit_exponentials"] = best->terms.size();
        context.results["relaxation_strain"] =
            value_json(best->terms.front().relaxation_strain, "-");
    }

    void run(Context& context) const
    {
        std::vector<Response> responses = respond_all(context);
        std::string table = "seed,outcome\n";
        for (const Response& r : responses)
            table += std::to_string(r.seed) + (r.jammed ? ",jammed\n" : ",flowing\n");
        io::write_file(context.folder.file(context.step_name + "_starts.csv"), table);
        std::erase_if(responses, [](const Response& r) { return r.jammed; });
        context.results["starts"] = starts;
        context.results["jammed"] = starts - static_cast<int>(responses.size());
        if (responses.size() < 2) {
            context.results["outcome"] = "no mean, fewer than two starts flow";
            return;
        }
        std::vector<double> before = column(responses.front().before, &Sample::strain);
        const std::vector<double> after = column(responses.front().after, &Sample::strain);
        for (double& strain : before) strain -= strain_before;
        std::vector<Quantity> quantities = quantities_of(responses);
        io::write_file(context.folder.file(context.step_name + ".csv"),
                       csv_text(before, after, quantities));
        report(context, responses, after, quantities);
        std::optional<Relaxation> best;
        for (Quantity& q : quantities) {
            const bool is_rate = q.name == "shear_rate";
            if (is_rate) fit(context, after, q, best);
            for (const char* drawn : {"shear_stress", "contact_number", "viscosity", "shear_rate"})
                if (q.name == drawn)
                    write_plot(context, context.step_name + "_" + q.name,
                               plot(before, after, q, is_rate ? &*best : nullptr));
        }
    }

    /// The rate before (second half), just after and at the end, and the viscosity of the jump.
    void report(Context& context, const std::vector<Response>& responses,
                const std::vector<double>& after, const std::vector<Quantity>& quantities) const
    {
        Columns before, jump;
        for (const Response& r : responses) {
            const std::vector<double> rates = column(r.before, &Sample::shear_rate);
            const auto half = std::span(rates).subspan(rates.size() / 2);
            double mean = 0;
            for (double rate : half) mean += rate / static_cast<double>(half.size());
            before.push_back({mean});
            jump.push_back({r.after.front().shear_rate - r.before.back().shear_rate});
        }
        const Columns stress(responses.size(), {stress_after - stress_before});
        const auto value = [](const EnsembleMean& mean, std::size_t k) {
            return Value{mean.mean[k], mean.standard_error[k]};
        };
        const EnsembleMean rate_before = ensemble_mean(before), jump_mean = ensemble_mean(jump);
        const auto& rate = *std::find_if(quantities.begin(), quantities.end(),
                                         [](const auto& q) { return q.name == "shear_rate"; });
        context.results["strain_after"] = after.back();
        context.results["rate_before"] = value_json(value(rate_before, 0), "rate0");
        context.results["rate_just_after"] = value_json(value(rate.after, 0), "rate0");
        context.results["rate_at_the_end"] =
            value_json(value(rate.after, after.size() - 1), "rate0");
        context.results["viscosity_of_the_jump"] =
            value_json(value(ensemble_ratio(stress, jump), 0), "eta0");
        context.results["viscosity_before"] = {{"mean", stress_before / rate_before.mean[0]},
                                               {"unit", "eta0"}};
    }
};

}

StepKind step_stress_step()
{
    return step_kind<StepStress>("step_stress",
                                 "mean response of many starts to a step in the imposed stress");
}

}
