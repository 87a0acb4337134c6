#include "render/polar_map.h"

#include "engine/error.h"
#include "render/colour_map.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <numbers>

using namespace sigmaflow;
using render::Colour;
using render::Image;
using render::PolarMap;

namespace {

/// Rings to 2, four sectors of 45 degrees; every value is a multiple of 0.1.
PolarMap example()
{
    PolarMap map;
    map.height = 600;
    map.title = "example";
    map.x_title = "$x$";
    map.y_title = "$y$";
    map.label = "$g$";
    map.largest_distance = 2;
    map.rings = 2;
    map.sectors = 4;
    map.values = {0, 0, 0, 0, 0.2, 0.4, 0.7, 1};
    return map;
}

struct Disc {
    double x, y, radius;
};

bool has_colour(const Image& image, int column, int row, Colour colour, int slack = 2)
{
    for (int c = 0; c < 3; ++c)
        if (std::abs(image.pixel(column, row)[c] - colour[c]) > slack) return false;
    return true;
}

std::vector<Colour> colours_of(const PolarMap& map)
{
    std::vector<Colour> colours;
    for (double value : map.values) colours.push_back(render::map_colour("inferno", value));
    return colours;
}

bool is_painted(const Image& image, int column, int row, const std::vector<Colour>& colours)
{
    return std::any_of(colours.begin(), colours.end(),
                       [&](Colour c) { return has_colour(image, column, row, c, 0); });
}

/// From the first painted row, the last one, and the first painted column; the colour bar is right
/// of the disc and not higher.
Disc disc(const Image& image, const std::vector<Colour>& colours)
{
    int left = image.width, top = image.height, bottom = 0;
    for (int row = 0; row < image.height; ++row)
        for (int column = 0; column < image.width; ++column)
            if (is_painted(image, column, row, colours)) {
                left = std::min(left, column);
                top = std::min(top, row);
                bottom = std::max(bottom, row);
            }
    const double radius = (bottom - top + 1) / 2.0;
    return {left + radius, top + radius, radius};
}

}

TEST(PolarMap, PutsEverySectorAndItsOppositeAtItsPlace)
{
    const PolarMap map = example();
    const Image image = render::render_polar_map(map);
    ASSERT_EQ(image.height, 600);
    ASSERT_EQ(image.width, 720);
    const std::vector<Colour> colours = colours_of(map);
    const Disc found = disc(image, colours);
    const double x = found.x, y = found.y, radius = found.radius;
    EXPECT_GT(radius, 180);
    const int right = static_cast<int>(x + radius);  // as wide as high
    const int beside_tick = static_cast<int>(y) + 10;
    EXPECT_TRUE(is_painted(image, right - 4, beside_tick, colours));
    EXPECT_FALSE(is_painted(image, right + 4, beside_tick, colours));
    for (int turn = 0; turn < 8; ++turn) {
        const double theta = (turn + 0.5) * std::numbers::pi / 4;
        const auto at = [&](double r) {
            return std::pair(static_cast<int>(std::lround(x + r / 2 * radius * std::cos(theta))),
                             static_cast<int>(std::lround(y - r / 2 * radius * std::sin(theta))));
        };
        const auto [outer_column, outer_row] = at(1.5);
        const Colour expected = render::map_colour("inferno", map.values[4 + turn % 4]);
        EXPECT_TRUE(has_colour(image, outer_column, outer_row, expected)) << turn;
        const auto [inner_column, inner_row] = at(0.5);
        EXPECT_TRUE(has_colour(image, inner_column, inner_row, render::map_colour("inferno", 0)))
            << turn;
    }
    // beyond the largest distance
    const int corner = static_cast<int>(0.95 * radius);
    EXPECT_TRUE(has_colour(image, static_cast<int>(x) + corner, static_cast<int>(y) - corner,
                           {255, 255, 255}, 0));
}

TEST(PolarMap, RefusesWhatItCannotDraw)
{
    PolarMap map = example();
    map.values.pop_back();
    EXPECT_THROW(render::render_polar_map(map), Error);
    map = example();
    map.height = 10;
    EXPECT_THROW(render::render_polar_map(map), Error);
    map = example();
    map.largest_distance = 0;
    EXPECT_THROW(render::render_polar_map(map), Error);
    map = example();
    map.rings = map.sectors = -1;
    EXPECT_THROW(render::render_polar_map(map), Error);
}

TEST(PolarMap, NothingButZerosIsDrawnInTheFirstColour)
{
    PolarMap map = example();
    map.values.assign(8, 0);
    const Image image = render::render_polar_map(map);
    EXPECT_TRUE(has_colour(image, 330, 270, render::map_colour("inferno", 0)));
}
