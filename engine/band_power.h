// engine/band_power.h -- the smallest contrast of two equal bands that the searches of
// band_search.h find, by putting bands into measured amplitudes; see uniformity.h.
#pragma once
#include "engine/uniformity.h"

namespace sigmaflow {

/// None if bands of the largest contrast are found too rarely. Good to 2 % and to the trials.
std::optional<double> smallest_steady_contrast(const Amplitudes& blocks, const BandShapes& shapes,
                                               const UniformitySettings& settings);

/// `expected` from excess_without_bands; its degrees are those of the independent instants.
std::optional<double> smallest_moving_contrast(const Amplitudes& amplitudes, int slabs,
                                               const std::vector<double>& expected,
                                               const UniformitySettings& settings);

}
