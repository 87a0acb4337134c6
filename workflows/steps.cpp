// The only list of steps. A new one: a file in steps/, a declaration in steps.h and a row here.
#include "workflows/steps.h"

#include <array>

namespace sigmaflow::workflows {

std::span<const StepKind> step_kinds()
{
    static const std::array kinds{pack_step(),       equilibrate_step(), shear_step(),
                                  flow_curve_step(), stability_step(),   velocity_profile_step(),
                                  uniformity_step(), energy_step(),      snapshot_step(),
                                  plot_step()};
    return kinds;
}

}
