#include "workflows/averages.h"

#include "engine/statistics.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace sigmaflow::workflows {

using Json = nlohmann::ordered_json;

namespace {

/// Strain over time, with the scatter of the time that each interval took.
Estimate rate_over_time(std::span<const Sample> samples)
{
    std::vector<double> taken;
    for (std::size_t i = 1; i < samples.size(); ++i)
        taken.push_back(samples[i].time - samples[i - 1].time);
    Estimate result = estimate_mean(taken);
    if (samples.size() < 2 || !(result.mean > 0)) return {};
    const double rate = (samples.back().strain - samples.front().strain) /
                        (samples.back().time - samples.front().time);
    result.standard_error *= rate / result.mean;
    result.mean = rate;
    return result;
}

}

Json quantity_json(double mean, double standard_error, std::string_view unit)
{
    return {{"mean", mean}, {"standard_error", standard_error}, {"unit", unit}};
}

Json quantity_json(const Value& value, std::string_view unit)
{
    return quantity_json(value.mean, value.standard_error, unit);
}

std::span<const Sample> samples_from(const Run& run, double strain)
{
    std::size_t first = 0;
    while (first < run.series.size() && run.series[first].strain < strain - 1e-9) ++first;
    return std::span(run.series).subspan(first);
}

std::span<const Sample> stationary_part(const Run& run)
{
    return run.start_up ? samples_from(run, *run.start_up) : std::span(run.series);
}

const SampleField& field_named(std::string_view name)
{
    for (const SampleField& field : sample_fields())
        if (field.name == name) return field;
    throw Error(ErrorKind::internal, std::string(name), "no such scalar");
}

std::vector<std::string_view> field_names()
{
    std::vector<std::string_view> names;
    for (const SampleField& field : sample_fields()) names.push_back(field.name);
    return names;
}

std::vector<double> column(std::span<const Sample> samples, double Sample::*value)
{
    std::vector<double> result;
    result.reserve(samples.size());
    for (const Sample& sample : samples) result.push_back(sample.*value);
    return result;
}

void find_start_up(Run& run)
{
    const bool imposed_rate = std::holds_alternative<ImposedRate>(run.control);
    const auto values =
        column(run.series, imposed_rate ? &Sample::shear_stress : &Sample::shear_rate);
    if (!values.empty())
        run.start_up = run.series[static_cast<std::size_t>(start_up_cut(values))].strain;
}

Json averages_json(const Run& run)
{
    const std::span<const Sample> samples = stationary_part(run);
    const Estimate rate = estimate_mean(column(samples, &Sample::shear_rate));
    const Estimate stress = estimate_mean(column(samples, &Sample::shear_stress));
    const Estimate rate_in_time = rate_over_time(samples);
    const bool imposed_rate = std::holds_alternative<ImposedRate>(run.control);
    const Estimate& varying = imposed_rate ? stress : rate;
    const auto viscosity = [&](const Estimate& over) {
        const double value = stress.mean / over.mean;
        const double error =
            std::hypot(stress.standard_error / stress.mean, over.standard_error / over.mean);
        return quantity_json(value, std::abs(value) * error, "eta0");
    };

    Json result;
    result["averages_from_strain"] = run.start_up.value_or(0);
    result["samples"] = samples.size();
    result["effective_samples"] = varying.effective_samples;
    result["errors_reliable"] = varying.reliable;
    result["viscosity"] = viscosity(rate);
    result["viscosity_time_average"] = viscosity(rate_in_time);
    result["shear_rate_time_average"] =
        quantity_json(rate_in_time.mean, rate_in_time.standard_error, "rate0");
    for (const SampleField& field : sample_fields()) {
        if (field.name == "strain" || field.name == "time" || field.name == "viscosity") continue;
        const Estimate e = estimate_mean(column(samples, field.value));
        result[std::string(field.name)] = quantity_json(e.mean, e.standard_error, field.unit);
    }
    return result;
}

std::vector<std::string> runs_like_the_last(const Plan& plan)
{
    std::vector<std::string> names;
    const auto is_shear = [](const PlannedRun& run) { return run.frames > 0; };
    const auto last = std::find_if(plan.runs.rbegin(), plan.runs.rend(), is_shear);
    for (const PlannedRun& run : plan.runs)
        if (is_shear(run) && run.volume_fraction == last->volume_fraction &&
            control_json(run.control) == control_json(last->control))
            names.push_back(run.name);
    return names;
}

Json control_json(const Control& control)
{
    if (const auto* stress = std::get_if<ImposedStress>(&control))
        return {{"stress", stress->value}};
    return {{"rate", std::get<ImposedRate>(control).value}};
}

}
