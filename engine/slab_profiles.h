// engine/slab_profiles.h -- velocity, volume fraction, shear stress and frictional contacts in
// slabs across the gradient or the vorticity direction.
//
// With w_ik the volume of sphere i in slab k (slabs.h), V_i its volume, V_k that of the slab:
//   nonaffine_velocity        sum_i w_ik (U_i - U_inf(x_i))_x / sum_i w_ik            [a rate0]
//   volume_fraction           sum_i w_ik / V_k                                        [-]
//   shear_stress              eta0 rate + sum_i (w_ik/V_i) S_i,xy / V_k               [sigma0]
//   frictional_contact_number sum_i w_ik z_i / sum_i w_ik, z_i the frictional contacts of i  [-]
// S_i is the stress of a particle (frame.h), so the mean of the slabs is the stress of the sample.
// None of them depends on the choice of periodic images. Without a critical load every touching
// pair is frictional, so what varies is the number of contacts, not a share of them.
//
// Tests: means over the slabs against the sample, translation by whole slabs, a sphere in one slab.
#pragma once
#include "engine/frame.h"

#include <vector>

namespace sigmaflow {

struct SlabProfiles {
    std::vector<double> position;  // slab centres over the length of the box [-], (0, 1)
    // an empty slab takes the value between its neighbours that are not empty
    std::vector<double> nonaffine_velocity, frictional_contact_number;
    std::vector<double> volume_fraction, shear_stress;
};

/// Across `axis` (gradient or vorticity). Errors: input (no slab, no particle, no frame of as many
/// particles).
SlabProfiles slab_profiles(const Frame& frame, Axis axis, int slabs);

/// Shear rate between the centres of neighbouring slabs over the mean one, from the non-affine
/// velocities in slabs across the gradient direction; value k lies on the upper face of slab k:
///   1 + K (v_{k+1} - v_k)/(shear_rate Ly),  v_K = v_0.  Its mean is 1.
/// Errors: numerics (rate zero or not finite).
std::vector<double> local_shear_rate(const std::vector<double>& nonaffine_velocity,
                                     double shear_rate, double height);

}
