// render/plot_grid.cpp -- coloured cells and their bar.
#include "render/particle_overlay.h"
#include "render/plot_parts.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow::render {
namespace {

/// The cells of one row; neighbours of one colour are one rectangle, which keeps files small. On
/// whole pixels no white shows between them.
void draw_row(Drawing& drawing, const ColourGrid& grid, const ColourScale& colours,
              const PlotLayout& layout, std::size_t row)
{
    const std::size_t columns = grid.x.size() - 1;
    const double top = std::round(layout.y.pixel(grid.y[row + 1]));
    const double bottom = std::round(layout.y.pixel(grid.y[row]));
    for (std::size_t i = 0; i < columns;) {
        const Colour colour = colours.colour(grid.values[row * columns + i]);
        std::size_t end = i + 1;
        while (end < columns && colours.colour(grid.values[row * columns + end]) == colour) ++end;
        const Rectangle cell{std::round(layout.x.pixel(grid.x[i])), top,
                             std::round(layout.x.pixel(grid.x[end])), bottom};
        const Fill area{{rectangle_contour(cell)}, {colour}, {}};
        drawing.fill(area, layout.frame);
        i = end;
    }
}

}

void draw_grid(Drawing& drawing, const Plot& plot, const PlotLayout& layout, const Fonts& fonts)
{
    if (!plot.grid) return;
    const ColourGrid& grid = *plot.grid;
    ColourScale colours{
        .map = grid.map, .range = {grid.minimum, grid.maximum}, .label = grid.label};
    colours.values_below = std::any_of(grid.values.begin(), grid.values.end(),
                                       [&](double value) { return value < grid.minimum; });
    colours.values_above = std::any_of(grid.values.begin(), grid.values.end(),
                                       [&](double value) { return value > grid.maximum; });
    for (std::size_t row = 0; row + 1 < grid.y.size(); ++row)
        draw_row(drawing, grid, colours, layout, row);
    ParticleLayout beside;
    beside.unit = layout.unit;
    beside.particles = layout.frame;
    beside.colour_bar = layout.colour_bar;
    if (colours.values_below) beside.colour_bar.bottom -= std::round(beside.colour_bar.width());
    draw_colour_bar(drawing, fonts, colours, beside);
}

}
