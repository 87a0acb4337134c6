// workflows/steps.h -- the list of steps.
#pragma once
#include "workflows/step.h"

#include <span>

namespace sigmaflow::workflows {

std::span<const StepKind> step_kinds();

StepKind pack_step();
StepKind equilibrate_step();
StepKind shear_step();
StepKind flow_curve_step();
StepKind stability_step();
StepKind velocity_profile_step();
StepKind uniformity_step();
StepKind energy_step();
StepKind snapshot_step();
StepKind plot_step();

}
