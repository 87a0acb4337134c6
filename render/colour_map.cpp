// render/colour_map.cpp
#include "render/colour_map.h"

#include "engine/error.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace sigmaflow::render {
namespace {

// Nine colours at equal distances; matplotlib's tables at 0, 1/8, ..., 1.
const std::vector<Colour> inferno{{0, 0, 4},      {33, 12, 74},   {87, 16, 110},
                                  {138, 34, 106}, {188, 55, 84},  {228, 90, 49},
                                  {249, 142, 9},  {249, 203, 53}, {252, 255, 164}};
const std::vector<Colour> viridis{{68, 1, 84},    {71, 45, 123},  {59, 82, 139},
                                  {44, 114, 142}, {33, 144, 140}, {39, 173, 129},
                                  {93, 200, 99},  {170, 220, 50}, {253, 231, 37}};
const std::vector<Colour> paper{
    {52, 52, 54}, {100, 96, 70}, {160, 146, 58}, {216, 194, 46}, {255, 236, 40}};
const std::vector<Colour> blue_red{{30, 56, 118},   {58, 110, 176},  {138, 180, 214},
                                   {236, 236, 234}, {232, 162, 132}, {192, 88, 66},
                                   {118, 20, 36}};
constexpr double darkest_inferno = 0.13;

/// A smooth curve through the knots (Catmull & Rom), held inside 0..255.
Colour interpolate(const std::vector<Colour>& knots, double share)
{
    const int last = static_cast<int>(knots.size()) - 1;
    const double at = share * last;
    const int i = std::min(static_cast<int>(at), last - 1);
    const double t = at - i;
    Colour colour;
    for (int channel = 0; channel < 3; ++channel) {
        const double p1 = knots[i][channel], p2 = knots[i + 1][channel];
        const double p0 = i > 0 ? knots[i - 1][channel] : 2 * p1 - p2;
        const double p3 = i + 2 <= last ? knots[i + 2][channel] : 2 * p2 - p1;
        const double value =
            p1 +
            0.5 * t *
                (p2 - p0 + t * (2 * p0 - 5 * p1 + 4 * p2 - p3 + t * (3 * (p1 - p2) + p3 - p0)));
        colour[channel] = std::clamp(static_cast<int>(std::lround(value)), 0, 255);
    }
    return colour;
}

}

Colour map_colour(const std::string& map, double share)
{
    const bool known = map == "inferno" || map == "viridis" || map == "paper" || map == "blue_red";
    if (!known)
        throw Error(ErrorKind::input, "colour_map",
                    "must be inferno, viridis, paper or blue_red, got \"" + map + "\"");
    if (std::isnan(share)) return {150, 150, 150};
    share = std::clamp(share, 0.0, 1.0);
    if (map == "viridis") return interpolate(viridis, share);
    if (map == "paper") return interpolate(paper, share);
    if (map == "blue_red") return interpolate(blue_red, share);
    return interpolate(inferno, darkest_inferno + (1 - darkest_inferno) * share);
}

}
