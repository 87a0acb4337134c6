// engine/packing.h -- random start at exactly the asked volume fraction.
//
// 1. radii: 1 and size_ratio, small_volume_share of the solid volume in the small ones, or a given
// list
// 2. a box of shape box_shape whose volume makes the volume fraction exact
// 3. uniform random positions from a counter-based generator, radii times 1.01, steepest descent of
// the
//    overlap energy until min xi > -0.01; at the true radii no pair touches then.
// Errors: input (ranges), numerics (no overlap-free packing within max_iterations).
#pragma once
#include "engine/state.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace sigmaflow {

struct PackingParameters {
    int particles = 500;              // [1, 10^7]
    double volume_fraction = 0.56;    // (0, random_close_packing]
    double size_ratio = 1.4;          // large over small radius [1, 10]
    double small_volume_share = 0.5;  // share of the solid volume in small spheres [0, 1]
    std::vector<double> radii;        // if not empty: these radii, in this order
    Vec3 box_shape{1, 1, 1};          // ratios of the box lengths
    std::uint64_t seed = 1;
    int max_iterations = 200000;
};

std::vector<double> packing_radii(const PackingParameters& parameters);

/// The volume fraction beyond which spheres of these radii have no random packing:
///   0.64 + 0.0658 d + 0.0857 S d^2, with polydispersity d (standard deviation over mean of the
///   radii) and skewness S (Desmond & Weeks, Phys. Rev. E 90, 022204, 2014; their 0.634 for equal
///   spheres raised to the customary value); not below 0.64,
///   nor above what spheres can fill if all smaller ones find room in the voids of the larger ones
///   and a size alone packs to 0.64 (Furnas, Ind. Eng. Chem. 23, 1052, 1931), for large ratios.
/// Four decimals.
double random_close_packing(const std::vector<double>& radii);

/// Lengths of the box of such a packing [a].
Vec3 packing_box(const PackingParameters& parameters);

/// Called now and then with the iteration and the smallest xi of the enlarged spheres.
using PackingProgress = std::function<void(int iteration, double smallest_xi)>;

State random_packing(const PackingParameters& parameters, const PackingProgress& progress = {});

}
