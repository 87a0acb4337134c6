// engine/pair_correlation.h -- where the neighbours of a particle are: g(r), g(r, theta) in the
// shear plane, and the directions of near neighbours.
//
// Distances r are those of the nearest images in the sheared box. A sphere of radius r <= half the
// smallest box length holds at most one image of each particle, so nothing is counted twice or
// missed up to there, and no further.
//
// One frame of n particles in a volume V has n (n - 1)/2 pairs; of independent, evenly spread
// points a region of volume v around each holds n (n - 1)/2 v/V of them on average, exactly. Hence
//   g(r)         pairs in the shell, v = 4 pi/3 (r_2^3 - r_1^3); between species n_a n_b v/V, or
//                n_a (n_a - 1)/2 v/V
//   g(r, theta)  pairs in the shell with |n_z| < b whose separation, or its opposite, points to
//   theta
//                from the flow towards the gradient, theta in [0, pi) (a pair has both
//                directions): v = (r_2^3 - r_1^3)/3 2b 2 d_theta
//   near         pairs with xi = 2 (r - s)/s < near_xi, s = a_i + a_j, and |n_z| < b: the density
//   of
//                theta, relative to that of isotropic neighbours
// are 1 for an ideal gas (Allen & Tildesley, Computer Simulation of Liquids, 1987, section 6.2).
// Quadrants of near neighbours (all n_z): compression has n_x n_y < 0, extension n_x n_y > 0.
// Quadrant anisotropy = (compression - extension)/(compression + extension), 0 if isotropic.
//
// Tests: ideal gas, shells of a sheared cubic lattice, exact directions, sum over species, slow
// twin, images, offset + Lx.
#pragma once
#include "engine/state.h"
#include "engine/statistics.h"

#include <span>
#include <vector>

namespace sigmaflow {

struct CorrelationGrid {
    double largest_distance = 5;  // [a] > 0, at most half the smallest box length
    int bins = 100;               // of the distance [1, 10^5]
    int map_bins = 50;            // of the distance in the shear plane [1, 10^4]
    int angles = 36;              // of theta [1, 10^4]
    double slab = 0.3;            // b [-] (0, 1]
    double near_xi = 0.1;         // [-], s (1 + near_xi/2) <= half the smallest box length

    double distance(int bin) const { return (bin + 0.5) * largest_distance / bins; }
    double map_distance(int bin) const { return (bin + 0.5) * largest_distance / map_bins; }
    double angle(int bin) const;  // [degrees]
};

/// The largest distance that a box allows, half of its smallest length [a].
double largest_pair_distance(const Box& box);

struct PairCorrelation {
    std::vector<double> all;                      // g of each distance
    std::vector<std::vector<double>> by_species;  // (0,0), (0,1), (1,1): empty if not two species
    std::vector<double> map;                      // g of [distance][angle]
    std::vector<double> near;                     // of each angle; empty without near neighbours
    double near_neighbours = 0;                   // per particle [-]
    double quadrant_anisotropy = 0;
};

/// Errors: input (grid out of its ranges, fewer than two particles).
PairCorrelation pair_correlation(const State& state, const CorrelationGrid& grid);

/// Means over frames with the same grid, with their errors.
struct MeanPairCorrelation {
    std::vector<Estimate> all;
    std::vector<std::vector<Estimate>> by_species;
    std::vector<Estimate> map, near;
    Estimate near_neighbours, quadrant_anisotropy;
};
MeanPairCorrelation mean_pair_correlation(std::span<const PairCorrelation> frames);

/// The highest bin of a g(r): the first peak, as far as spheres do not crystallise.
struct Peak {
    double distance = 0;  // centre of the bin [a]
    Estimate height;
};
Peak highest_peak(std::span<const Estimate> g, const CorrelationGrid& grid);

}
