// workflows/help.h -- help generated from the declared parameters.
#pragma once
#include <string>

namespace sigmaflow::workflows {

/// The steps in one line each and the parameters of the suspension and the model; for a step its
/// parameters with unit, default, limits and meaning. Errors: usage (no such step).
std::string steps_help(const std::string& step = "");

}
