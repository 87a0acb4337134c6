// engine/forces/repulsion.h -- screened repulsion |F_R| = F* A exp(-gap/lambda_D), F* A while
// touching.
//
// Mari et al., Phys. Rev. E 91, 052302 (2015), section II. Central, no torque, for xi <
// repulsion_range. Deviation: the paper prints A = 1; the authors' code has used a_i a_j/((a_i +
// a_j) a) throughout, and the stress and rate axes of the paper follow from that, so it is the
// default (`reduced_radius`).
#pragma once
#include "engine/model.h"
#include "engine/pairs.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow {

/// Size of the repulsion [eta0 rate0 a^2] >= 0; on i it acts along -normal.
inline double repulsion(const Pair& pair, double a, double b, const Model& m)
{
    if (!(pair.xi < m.repulsion_range) || m.repulsion == 0) return 0;
    const double reduced = a * b / (a + b);
    const double amplitude = m.repulsion_amplitude == RepulsionAmplitude::reduced_radius ? reduced
                             : m.repulsion_amplitude == RepulsionAmplitude::derjaguin ? 2 * reduced
                                                                                      : 1.;
    return reference_force * m.repulsion * amplitude *
           std::exp(-std::max(pair.gap, 0.) / m.debye_length);
}

}
