// render/line_plot.cpp -- a plot from its parts, as pixels or as SVG.
#include "render/line_plot.h"

#include "engine/error.h"
#include "render/drawing.h"
#include "render/fonts.h"
#include "render/plot_parts.h"

#include <algorithm>
#include <functional>

namespace sigmaflow::render {
namespace {

void check_lengths(const std::string& where, std::size_t expected,
                   const std::vector<double>& values, const char* name, bool may_be_empty)
{
    if (values.size() == expected || (may_be_empty && values.empty())) return;
    throw Error(ErrorKind::input, where,
                std::string(name) + " has " + std::to_string(values.size()) + " values, x has " +
                    std::to_string(expected));
}

void check_grid(const ColourGrid& grid)
{
    const auto refuse = [](const std::string& problem) {
        throw Error(ErrorKind::input, "grid", problem);
    };
    for (const auto* edges : {&grid.x, &grid.y})
        if (edges->size() < 2 || std::adjacent_find(edges->begin(), edges->end(),
                                                    std::greater_equal<>()) != edges->end())
            refuse("needs two edges or more, ascending");
    const std::size_t cells = (grid.x.size() - 1) * (grid.y.size() - 1);
    if (grid.values.size() != cells)
        refuse("has " + std::to_string(grid.values.size()) + " values, its edges make " +
               std::to_string(cells) + " cells");
    if (!(grid.minimum < grid.maximum)) refuse("has an empty range of colours");
}

void check(const Plot& plot)
{
    for (int size : {plot.width, plot.height})
        if (size < 64 || size > 16384)
            throw Error(
                ErrorKind::input, "plot",
                "the picture size must be in [64, 16384] pixels, got " + std::to_string(size));
    for (std::size_t i = 0; i < plot.series.size(); ++i) {
        const Series& series = plot.series[i];
        const std::string where = "series " + std::to_string(i);
        check_lengths(where, series.x.size(), series.y, "y", false);
        check_lengths(where, series.x.size(), series.x_error, "x_error", true);
        check_lengths(where, series.x.size(), series.y_error, "y_error", true);
    }
    for (std::size_t i = 0; i < plot.bands.size(); ++i) {
        const Band& band = plot.bands[i];
        const std::string where = "band " + std::to_string(i);
        check_lengths(where, band.x.size(), band.lower, "lower", false);
        check_lengths(where, band.x.size(), band.upper, "upper", false);
    }
    if (plot.grid) check_grid(*plot.grid);
}

Drawing draw_plot(const Plot& plot)
{
    check(plot);
    const Fonts fonts;
    const PlotLayout layout = plot_layout(plot, fonts);
    Drawing drawing{plot.width, plot.height, {}};
    draw_grid(drawing, plot, layout, fonts);
    draw_spans(drawing, plot, layout);
    draw_bands(drawing, plot, layout);
    draw_series(drawing, plot, layout);
    draw_span_labels(drawing, plot, layout, fonts);
    draw_axes(drawing, plot, layout, fonts);
    draw_legend(drawing, plot, layout, fonts);
    return drawing;
}

}

Image render_plot(const Plot& plot)
{
    const Drawing drawing = draw_plot(plot);
    Image image(plot.width, plot.height);
    rasterise(drawing, image);
    return image;
}

std::string plot_svg(const Plot& plot)
{
    return svg_text(draw_plot(plot));
}

}
