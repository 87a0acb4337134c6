// workflows/measured_curves.h -- the mean flow of the shearing steps before a step, as curves: one
// for each volume fraction.
#pragma once
#include "engine/flow_curve.h"
#include "engine/statistics.h"
#include "workflows/step.h"

#include <map>
#include <string>
#include <vector>

namespace sigmaflow::workflows {

/// The mean flow of one run.
struct Measured {
    std::string run;
    bool imposed_rate = false, jammed = false;
    Estimate stress, rate, contact_number;  // what is imposed has no error

    double viscosity() const { return stress.mean / rate.mean; }  // [eta0]
    double viscosity_error() const;
    FlowPoint point() const { return {stress.mean, rate.mean, rate.standard_error, jammed}; }
};

/// One volume fraction, as it was asked for; by the imposed stress or rate.
struct Curve {
    std::map<double, Measured> by_stress, by_rate;
};
using Curves = std::map<double, Curve>;

/// The steps "shear" before this one, which must have two stresses at each volume fraction that was
/// sheared at an imposed stress. Errors: input.
std::vector<PlannedRun> runs_for_curves(const io::JsonNode& node, const Plan& plan);

/// A jammed run has the rate 0 without error.
Measured measured(const Run& run);

/// Of two runs at one stress or rate the later one counts.
Curves curves_of(const Context& context, const std::vector<PlannedRun>& planned);

}
