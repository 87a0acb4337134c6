// workflows/steps.h -- the list of steps.
#pragma once
#include "workflows/step.h"

#include <span>

namespace sigmaflow::workflows {

std::span<const StepKind> step_kinds();

StepKind pack_step();
StepKind equilibrate_step();
StepKind shear_step();
StepKind stored_run_step();
StepKind stored_state_step();
StepKind flow_curve_step();
StepKind stability_step();
StepKind fluctuations_step();
StepKind adaptive_flow_curve_step();
StepKind statistics_step();
StepKind compare_step();
StepKind jamming_step();
StepKind frictional_fraction_step();
StepKind step_stress_step();
StepKind wyart_cates_step();
StepKind one_dimensional_flow_step();
StepKind velocity_profile_step();
StepKind contacts_step();
StepKind structure_step();
StepKind nonaffine_step();
StepKind uniformity_step();
StepKind energy_step();
StepKind snapshot_step();
StepKind movie_step();
StepKind plot_step();
StepKind panels_step();

}
