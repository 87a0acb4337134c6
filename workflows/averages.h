// workflows/averages.h -- averages of a stationary run for summary.json.
//
// The series has equal strain intervals, so a plain mean is an average over strain. The average
// over time of the shear rate is strain over time. Viscosities are stress over mean rate, never the
// mean of stress over rate.
#pragma once
#include "engine/value.h"
#include "workflows/step.h"

#include <nlohmann/json_fwd.hpp>

namespace sigmaflow::workflows {

/// The samples after the start-up.
std::span<const Sample> stationary_part(const Run& run);

/// Of sample_fields(). Error(internal) for an unknown name.
const SampleField& field_named(std::string_view name);
std::vector<std::string_view> field_names();

/// One column of samples.
std::vector<double> column(std::span<const Sample> samples, double Sample::*value);

/// Sets run.start_up to where the shear rate (or, under an imposed rate, the stress) has become
/// stationary.
void find_start_up(Run& run);

/// {"mean", "standard_error", "unit"}
nlohmann::ordered_json quantity_json(double mean, double standard_error, std::string_view unit);
nlohmann::ordered_json quantity_json(const Value& value, std::string_view unit);

/// Samples at a strain and beyond.
std::span<const Sample> samples_from(const Run& run, double strain);

/// {"shear_rate": {"mean", "standard_error", "unit", ...}, "viscosity": ..., ...}
nlohmann::ordered_json averages_json(const Run& run);

/// The steps "shear" so far at the volume fraction and stress (or rate) of the last one.
std::vector<std::string> runs_like_the_last(const Plan& plan);

/// {"stress": 2} or {"rate": 1}
nlohmann::ordered_json control_json(const Control& control);

}
