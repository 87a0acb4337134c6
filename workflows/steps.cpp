// The only list of steps. A new one: a file in steps/, a declaration in steps.h and a row here.
#include "workflows/steps.h"

#include <array>

namespace sigmaflow::workflows {

std::span<const StepKind> step_kinds()
{
    static const std::array kinds{pack_step(),
                                  equilibrate_step(),
                                  shear_step(),
                                  step_stress_step(),
                                  stored_run_step(),
                                  stored_state_step(),
                                  flow_curve_step(),
                                  stability_step(),
                                  fluctuations_step(),
                                  adaptive_flow_curve_step(),
                                  statistics_step(),
                                  compare_step(),
                                  jamming_step(),
                                  wyart_cates_step(),
                                  frictional_fraction_step(),
                                  contacts_step(),
                                  structure_step(),
                                  nonaffine_step(),
                                  one_dimensional_flow_step(),
                                  uniformity_step(),
                                  energy_step(),
                                  velocity_profile_step(),
                                  snapshot_step(),
                                  movie_step(),
                                  plot_step(),
                                  panels_step()};
    return kinds;
}

}
