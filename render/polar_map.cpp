// render/polar_map.cpp -- colours pixel by pixel, axes as in a line plot, bar as beside particles.
#include "render/polar_map.h"

#include "engine/error.h"
#include "render/particle_overlay.h"
#include "render/plot_parts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sigmaflow::render {
namespace {

constexpr int oversampling = 3;  // in each direction: smooth edges

void check(const PolarMap& map)
{
    if (map.height < 64 || map.height > 16384)
        throw Error(ErrorKind::input, "polar map",
                    "the height must be in [64, 16384] pixels, got " + std::to_string(map.height));
    const auto bins = static_cast<std::size_t>(std::max(map.rings, 0)) * std::max(map.sectors, 0);
    if (map.rings < 1 || map.sectors < 1 || map.values.size() != bins)
        throw Error(ErrorKind::input, "polar map",
                    "needs as many values as rings times sectors, at least one, got " +
                        std::to_string(map.values.size()));
    if (!(map.largest_distance > 0) || !std::isfinite(map.largest_distance))
        throw Error(ErrorKind::input, "polar map",
                    "the largest distance must be finite and > 0, got " +
                        std::to_string(map.largest_distance));
}

ColourScale colour_scale(const PolarMap& map)
{
    ColourScale scale;
    scale.map = map.colour_map;
    scale.label = map.label;
    scale.range = colour_range(map.values, false);
    scale.range.from = 0;
    for (const double value : map.values)
        scale.values_above = scale.values_above || value > scale.range.to * (1 + 1e-9);
    return scale;
}

/// The axes with a square frame; the bar finds room to the right.
PlotLayout square_layout(Plot& plot, const Fonts& fonts)
{
    PlotLayout layout = plot_layout(plot, fonts);
    for (int pass = 0; pass < 3; ++pass) {
        plot.width += std::lround(layout.frame.height() - layout.frame.width());
        layout = plot_layout(plot, fonts);
    }
    return layout;
}

/// Number of the bin at a point, -1 beyond the largest distance.
int bin_at(const PolarMap& map, double x, double y)
{
    const double r = std::hypot(x, y);
    if (r >= map.largest_distance) return -1;
    double theta = std::atan2(y, x);
    if (theta < 0) theta += std::numbers::pi;
    const int ring =
        std::min(static_cast<int>(r / map.largest_distance * map.rings), map.rings - 1);
    const int sector = static_cast<int>(theta / std::numbers::pi * map.sectors) % map.sectors;
    return ring * map.sectors + sector;
}

void paint(Image& image, const PolarMap& map, const PlotLayout& layout, const ColourScale& scale)
{
    std::vector<Colour> colours;
    for (const double value : map.values) colours.push_back(scale.colour(value));
    const Rectangle& f = layout.frame;
    const double R = map.largest_distance;
    for (int row = static_cast<int>(f.top); row < f.bottom; ++row)
        for (int column = static_cast<int>(f.left); column < f.right; ++column) {
            std::array<int, 3> sum{};
            for (int k = 0; k < oversampling * oversampling; ++k) {
                const double right = column + (k % oversampling + 0.5) / oversampling;
                const double down = row + (k / oversampling + 0.5) / oversampling;
                const int bin = bin_at(map, R * (2 * (right - f.left) / f.width() - 1),
                                       R * (1 - 2 * (down - f.top) / f.height()));
                for (int c = 0; c < 3; ++c) sum[c] += bin < 0 ? 255 : colours[bin][c];
            }
            for (int c = 0; c < 3; ++c)
                image.pixel(column, row)[c] =
                    static_cast<std::uint8_t>(sum[c] / (oversampling * oversampling));
        }
}

}

Image render_polar_map(const PolarMap& map)
{
    check(map);
    const Fonts fonts;
    Plot plot;
    plot.width = plot.height = map.height;
    plot.title = map.title;
    plot.x.title = map.x_title;
    plot.y.title = map.y_title;
    plot.x.minimum = plot.y.minimum = -map.largest_distance;
    plot.x.maximum = plot.y.maximum = map.largest_distance;
    const PlotLayout layout = square_layout(plot, fonts);

    const int width = static_cast<int>(std::lround(1.2 * map.height));
    const ColourScale scale = colour_scale(map);
    const double unit = layout.unit;
    ParticleLayout bar;
    bar.unit = unit;
    bar.particles = layout.frame;
    bar.colour_bar = {std::round(layout.frame.right + 50 * unit),
                      std::round(layout.frame.top + 110 * unit),
                      std::round(layout.frame.right + 86 * unit), layout.frame.bottom};
    Drawing drawing{width, map.height, {}};
    draw_axes(drawing, plot, layout, fonts);
    draw_colour_bar(drawing, fonts, scale, bar);

    Image image(width, map.height);
    paint(image, map, layout, scale);
    rasterise(drawing, image);
    return image;
}

}
