// engine/velocity_profile.h -- mean flow velocity in slabs across the gradient direction.
//
// Slab k of `bins`: y in [k, k + 1) Ly/bins. A sphere counts in every slab that it overlaps, with
// the volume of the overlap as its weight; a sphere that sticks out over the top goes on in the
// bottom slab.
//   u_k = y_k/Ly + sum_i w_ik (U_i,x - shear_rate y_i) / (shear_rate Ly sum_i w_ik),  y_k slab
//   centre
// that is, the non-affine velocities are averaged and the affine profile is added at the slab
// centre. The non-affine velocity is the same for all periodic images of a particle, U_x and y are
// not, so every choice of images gives the same profile, and an affine flow gives u_k = y_k/Ly
// exactly, also where the centres of the particles are not spread evenly over the slab.
//
// Tests: affine flow, choice of images, two-banded flow, conservation: sum_k (solid volume in k)
// times (u_k - y_k/Ly) equals the same sum over particles.
#pragma once
#include "engine/state.h"
#include "engine/types.h"

#include <vector>

namespace sigmaflow {

struct VelocityProfile {
    std::vector<double> y;                // slab centres y/Ly [-], (0, 1)
    std::vector<double> u;                // U_x/(shear_rate Ly) [-]; NaN in an empty slab
    std::vector<int> count;               // particles with their centre in the slab
    std::vector<double> volume_fraction;  // solid volume over slab volume [-]
};

/// `velocity` U [a rate0] belongs to state.position, [n]; wrapped or not. Throws Error(input) for
/// bins < 1, and Error(numerics) for a shear rate that is zero or not finite.
VelocityProfile velocity_profile(const State& state, const std::vector<Vec3>& velocity,
                                 double shear_rate, int bins);

/// Distance of a profile from the straight line of uniform shear, u = y.
struct Uniformity {
    double largest_deviation = 0;  // max |u - y| of the mean profile [-]
    double rms_deviation = 0;      // root of the mean of (u - y)^2 over the slabs [-]
    // Mean of ((u - y)/standard_error)^2. About 1 (somewhat more for fewer than 10 profiles) if the
    // deviations are noise; neighbouring slabs share particles, so it scatters more than
    // chi^2/bins. NaN with fewer than 2 profiles.
    double chi2_per_bin = 0;
    double slope = 1;  // du/dy, mean over the profiles of their least-squares slopes [-]
    double slope_error =
        0;  // standard error from the scatter between profiles; NaN with fewer than 2
};

struct MeanProfile {
    std::vector<double> y, u;            // [-]; u NaN in a slab that was always empty
    std::vector<double> standard_error;  // of u; NaN with fewer than 2 profiles
    std::vector<double> volume_fraction;
    int profiles = 0;
    Uniformity uniformity;
};

/// Mean over profiles with the same slabs that are about independent: one strain unit apart. The
/// slope is fitted to each profile (not to the mean, weighted by the errors), because the
/// deviations of neighbouring slabs are correlated and only the scatter between profiles knows how
/// much. Throws Error(input) for no profile or different numbers of slabs.
MeanProfile mean_profile(const std::vector<VelocityProfile>& profiles);

}
