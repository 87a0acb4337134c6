// render/polar_map.h -- a function of distance and angle in a plane, as colours, with axes and a
// colour bar.
//
// The function is the same at opposite points; every bin is filled evenly, so nothing is smoothed.
// Colours run from 0 to a round 99 % quantile, what lies above is marked on the bar; beyond the
// largest distance the picture is white. No graphics driver is needed.
// Errors: rendering (a font is missing), input (values that are not rings times sectors, no size).
#pragma once
#include "render/image.h"

#include <string>
#include <vector>

namespace sigmaflow::render {

struct PolarMap {
    int height = 1080;  // [64, 16384]; the picture is a fifth wider than high
    std::string title, x_title, y_title;
    std::string label;  // of the colours
    std::string colour_map = "inferno";
    double largest_distance = 1;
    int rings = 1, sectors = 1;  // from the middle; from x towards y over half a turn
    std::vector<double> values;  // [ring][sector]
};

Image render_polar_map(const PolarMap& map);

}
