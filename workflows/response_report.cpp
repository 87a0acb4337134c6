#include "workflows/response_report.h"

#include "engine/ensemble.h"
#include "engine/memory_kernel.h"
#include "io/atomic_file.h"
#include "workflows/averages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::ordered_json;
using Columns = std::vector<std::vector<double>>;  // [starts][strains]

constexpr double shown_before = 0.1;  // strain ahead of the step in the pictures
constexpr std::array drawn{"shear_stress", "contact_number", "viscosity", "shear_rate"};
constexpr std::array fitted{"contact_number", "viscosity", "shear_rate"};

template <class List>
bool contains(const List& list, const std::string& name)
{
    return std::find(list.begin(), list.end(), name) != list.end();
}

struct Quantity {
    std::string name, unit, axis;
    EnsembleMean before, after;
    Columns members;  // after the step
    std::optional<Relaxation> fit;
};

Columns columns(const std::vector<Response>& responses, std::vector<Sample> Response::*part,
                double Sample::*value)
{
    Columns result;
    for (const Response& response : responses) result.push_back(column(response.*part, value));
    return result;
}

/// Pseudo-values of the ratio (the first order of the jackknife): their mean is the ratio of the
/// means.
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
    const auto before = [&](double Sample::*value) {
        return columns(responses, &Response::before, value);
    };
    const auto after = [&](double Sample::*value) {
        return columns(responses, &Response::after, value);
    };
    for (const SampleField& field : sample_fields()) {
        if (field.name == "strain" || field.name == "time") continue;
        Quantity q{.name = std::string(field.name),
                   .unit = std::string(field.unit),
                   .axis = axis_text(field),
                   .before = {},
                   .after = {},
                   .members = {},
                   .fit = {}};
        if (field.name == "viscosity") {
            q.members = ratio_members(after(&Sample::shear_stress), after(&Sample::shear_rate));
            q.before = ensemble_ratio(before(&Sample::shear_stress), before(&Sample::shear_rate));
        } else {
            q.members = after(field.value);
            q.before = ensemble_mean(before(field.value));
        }
        q.after = ensemble_mean(q.members);
        result.push_back(std::move(q));
    }
    return result;
}

const Quantity& named(const std::vector<Quantity>& quantities, std::string_view name)
{
    return *std::find_if(quantities.begin(), quantities.end(),
                         [&](const Quantity& q) { return q.name == name; });
}

std::string csv_text(const std::vector<double>& before, const std::vector<double>& after,
                     const std::vector<Quantity>& quantities)
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

Value value_at(const EnsembleMean& mean, std::size_t k)
{
    return {mean.mean[k], mean.standard_error[k]};
}

Json fit_json(const Relaxation& fit, const std::string& unit)
{
    Json json{{"exponentials", fit.terms.size()}};
    json["terms"] = Json::array();
    for (const RelaxationTerm& term : fit.terms)
        json["terms"].push_back(
            {{"amplitude", quantity_json(term.amplitude, unit)},
             {"relaxation_strain", quantity_json(term.relaxation_strain, "-")}});
    json["plateau"] = quantity_json(fit.plateau, unit);
    json["chi2_per_degree"] = fit.chi2_per_degree;
    json["aic"] = fit.aic;
    json["resolved"] = fit.resolved;
    return json;
}

/// One and two exponentials; the better one is kept.
Json fit(Quantity& q, const std::vector<double>& strain)
{
    constexpr int resamples = 200;
    constexpr std::uint64_t seed = 1;
    const Relaxation one = fit_relaxation_of_members(strain, q.members, 1, resamples, seed);
    const Relaxation two = fit_relaxation_of_members(strain, q.members, 2, resamples, seed);
    q.fit = better_of(one, two);
    return {{"one", fit_json(one, q.unit)},
            {"two", fit_json(two, q.unit)},
            {"better", q.fit->terms.size() == 1 ? "one" : "two"}};
}

/// What "stability" takes over: weights are those of the rate's exponentials, relative to each
/// other (engine/stability.h). Nothing if they are not resolved, or of different signs.
std::optional<Json> memory_json(const Relaxation& rate, double viscosity_of_the_jump)
{
    double sum = 0;
    for (const RelaxationTerm& term : rate.terms) sum += term.amplitude.mean;
    Json json;
    for (const RelaxationTerm& term : rate.terms) {
        if (!(term.amplitude.mean / sum > 0)) return std::nullopt;
        json["relaxation_strains"].push_back(term.relaxation_strain.mean);
        json["relaxation_strain_errors"].push_back(term.relaxation_strain.standard_error);
        json["weights"].push_back(term.amplitude.mean / sum);
        json["weight_errors"].push_back(term.amplitude.standard_error / std::abs(sum));
    }
    json["instantaneous_viscosity"] = viscosity_of_the_jump;
    if (!rate.resolved) return std::nullopt;
    return json;
}

render::Plot plot_of(const std::vector<double>& before, const std::vector<double>& after,
                     const Quantity& q, const PictureSize& size)
{
    render::Plot plot = size.plot();
    plot.x.title = "strain since the step";
    plot.y.title = q.axis;
    render::Band band;
    render::Series mean;
    const auto add = [&](double strain, const Value& value) {
        if (strain < -shown_before) return;
        mean.x.push_back(strain);
        mean.y.push_back(value.mean);
        band.x.push_back(strain);
        band.lower.push_back(value.mean - value.standard_error);
        band.upper.push_back(value.mean + value.standard_error);
    };
    for (std::size_t k = 0; k < before.size(); ++k) add(before[k], value_at(q.before, k));
    for (std::size_t k = 0; k < after.size(); ++k) add(after[k], value_at(q.after, k));
    band.label = "standard error";
    band.colour = render::Colour{150, 185, 230};
    mean.label = "mean of " + std::to_string(q.members.size()) + " starts";
    mean.colour = render::Colour{20, 60, 140};
    if (q.name != "shear_stress") plot.bands.push_back(std::move(band));
    plot.series.push_back(std::move(mean));
    if (!q.fit) return plot;
    render::Series curve;
    for (double strain : after) {
        curve.x.push_back(strain);
        curve.y.push_back(q.fit->at(strain));
    }
    const RelaxationTerm& slowest = q.fit->terms.front();
    curve.label = std::string(q.fit->terms.size() == 1 ? "exponential" : "two exponentials") +
                  ", relaxation strain " + short_number(slowest.relaxation_strain.mean);
    if (q.fit->terms.size() == 2)
        curve.label += " and " + short_number(q.fit->terms.back().relaxation_strain.mean);
    curve.line = render::Line::dashed;
    curve.colour = render::Colour{200, 60, 30};
    plot.series.push_back(std::move(curve));
    return plot;
}

/// The rate before (second half of that run), just after and at the end; the viscosity of the jump.
void report_rates(Context& context, const StressStep& step, const std::vector<Response>& responses,
                  const Quantity& rate)
{
    Columns before, jump;
    for (const Response& r : responses) {
        const std::vector<double> rates = column(r.before, &Sample::shear_rate);
        const auto middle = rates.begin() + static_cast<std::ptrdiff_t>(rates.size() / 2);
        const double count = static_cast<double>(rates.end() - middle);
        before.push_back({std::accumulate(middle, rates.end(), 0.) / count});
        jump.push_back({r.after.front().shear_rate - r.before.back().shear_rate});
    }
    const Columns stress(responses.size(), {step.stress_after - step.stress_before});
    const Columns old_stress(responses.size(), {step.stress_before});
    Json& results = context.results;
    results["rate_before"] = quantity_json(value_at(ensemble_mean(before), 0), "rate0");
    results["rate_just_after"] = quantity_json(value_at(rate.after, 0), "rate0");
    results["rate_at_the_end"] =
        quantity_json(value_at(rate.after, rate.after.mean.size() - 1), "rate0");
    results["viscosity_before"] =
        quantity_json(value_at(ensemble_ratio(old_stress, before), 0), "eta0");
    results["viscosity_of_the_jump"] =
        quantity_json(value_at(ensemble_ratio(stress, jump), 0), "eta0");
}

}

std::string_view response_outcome(const Response& response)
{
    if (!response.packed) return "not packed";
    return response.jammed ? "jammed" : "flowing";
}

std::vector<std::string> response_pictures()
{
    std::vector<std::string> endings;
    for (const char* name : drawn) endings.push_back(std::string("_") + name);
    return endings;
}

void report_response(Context& context, const StressStep& step,
                     const std::vector<Response>& responses, const PictureSize& size)
{
    constexpr std::size_t fewest = 3;  // for errors from the scatter between starts
    if (responses.size() < fewest) {
        context.results["outcome"] = "no mean, fewer than three starts flow";
        return;
    }
    std::vector<double> before = column(responses.front().before, &Sample::strain);
    const std::vector<double> after = column(responses.front().after, &Sample::strain);
    for (double& strain : before) strain -= step.strain_before;
    std::vector<Quantity> quantities = quantities_of(responses);
    io::write_file(context.folder.file(context.step_name + ".csv"),
                   csv_text(before, after, quantities));
    report_rates(context, step, responses, named(quantities, "shear_rate"));
    for (Quantity& q : quantities)
        if (contains(fitted, q.name)) context.results["fits"][q.name] = fit(q, after);
    const Quantity& rate = named(quantities, "shear_rate");
    context.results["relaxation_strain"] =
        quantity_json(rate.fit->terms.front().relaxation_strain, "-");
    const auto memory =
        memory_json(*rate.fit, context.results["viscosity_of_the_jump"]["mean"].get<double>());
    if (memory) context.results["memory"] = *memory;
    context.results["outcome"] =
        memory ? "the rate relaxes" : "the relaxation of the rate is not resolved";
    for (const Quantity& q : quantities)
        if (contains(drawn, q.name))
            write_plot(context, context.step_name + "_" + q.name, plot_of(before, after, q, size));
}

}
