// render/colour_map.h -- numbers to colours.
//
//   inferno, viridis   perceptually uniform maps of matplotlib (N. J. Smith, S. van der Walt, CC0);
//                      inferno begins where spheres are bright enough to show their shading
//   paper              dark grey to yellow, as in Mari et al., Phys. Rev. E 91, 052302, Fig. 3
//   blue_red           for what lies on both sides of a middle value: lightest in the middle
#pragma once
#include "render/image.h"

#include <string>

namespace sigmaflow::render {

/// Colour for a share in [0, 1] of the range; outside it the end colours, grey for NaN.
/// Error: input (no such map).
Colour map_colour(const std::string& map, double share);

}
