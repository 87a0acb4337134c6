// render/plot_data.cpp -- lines, markers, error bars, bands and spans.
#include "render/plot_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace sigmaflow::render {
namespace {

constexpr double error_width = 2.0, cap_length = 6, marker_radius = 9;

/// Okabe & Ito's colours, told apart by colour-blind readers, too; their yellow is too pale for
/// lines.
constexpr std::array<Colour, 7> cycle{{{0, 114, 178},
                                       {213, 94, 0},
                                       {0, 158, 115},
                                       {204, 121, 167},
                                       {230, 159, 0},
                                       {86, 180, 233},
                                       {40, 40, 46}}};

std::vector<double> dash_pattern(Line line, double width)
{
    if (line == Line::dashed) return {4.5 * width, 3 * width};
    if (line == Line::dotted) return {1.2 * width, 1.8 * width};
    return {};
}

void draw_line(Drawing& drawing, const Contour& points, Line line, Colour colour, double width,
               const std::optional<Rectangle>& clip)
{
    if (line == Line::none || points.size() < 2) return;
    drawing.stroke({.points = points,
                    .ink = {colour},
                    .width = width,
                    .dashes = dash_pattern(line, width),
                    .round = line == Line::solid},
                   clip);
}

Contour polygon(Point centre, double radius, int corners, double turn)
{
    Contour contour;
    for (int i = 0; i < corners; ++i) {
        const double angle = turn + 2 * std::numbers::pi * i / corners;
        contour.push_back(
            {centre.x + radius * std::cos(angle), centre.y - radius * std::sin(angle)});
    }
    return contour;
}

/// Sizes are chosen such that all markers look equally large.
Contour marker_contour(Marker marker, Point centre, double radius)
{
    constexpr double quarter = std::numbers::pi / 4;
    if (marker == Marker::square) return polygon(centre, 1.25 * radius, 4, quarter);
    if (marker == Marker::triangle) return polygon(centre, 1.40 * radius, 3, 2 * quarter);
    if (marker == Marker::diamond) return polygon(centre, 1.40 * radius, 4, 0);
    return circle_contour(centre, radius);
}

void draw_marker(Drawing& drawing, const Series& series, Colour colour, Point centre, double unit)
{
    const double radius = marker_radius * unit, width = 2.4 * unit;
    if (series.marker == Marker::none) return;
    if (series.marker == Marker::cross) {
        for (double side : {-1.0, 1.0})
            drawing.stroke({.points = {{centre.x - radius, centre.y - side * radius},
                                       {centre.x + radius, centre.y + side * radius}},
                            .ink = {colour},
                            .width = 1.3 * width,
                            .dashes = {}});
        return;
    }
    Contour contour = marker_contour(series.marker, centre, radius);
    drawing.fill({{contour}, {series.open_marker ? Colour{255, 255, 255} : colour}, {}});
    if (!series.open_marker) return;
    contour.push_back(contour[0]);
    drawing.stroke(
        {.points = contour, .ink = {colour}, .width = width, .dashes = {}, .round = true});
}

void draw_error_bar(Drawing& drawing, Point from, Point to, Colour colour, double unit,
                    const std::optional<Rectangle>& clip)
{
    const double length = std::hypot(to.x - from.x, to.y - from.y);
    if (!(length > 0)) return;
    const Point along{(to.x - from.x) / length, (to.y - from.y) / length};
    const double cap = cap_length * unit, width = error_width * unit;
    const auto draw = [&](Point a, Point b) {
        drawing.stroke({.points = {a, b}, .ink = {colour}, .width = width, .dashes = {}}, clip);
    };
    draw(from, to);
    for (const Point& end : {from, to})
        draw({end.x - cap * along.y, end.y + cap * along.x},
             {end.x + cap * along.y, end.y - cap * along.x});
}

/// The lower end of a bar that a logarithmic axis cannot show lies below the frame.
Point finite(Point p, Point fallback)
{
    return {std::isfinite(p.x) ? p.x : fallback.x, std::isfinite(p.y) ? p.y : fallback.y};
}

void draw_error_bars(Drawing& drawing, const Series& series, Colour colour,
                     const PlotLayout& layout)
{
    const Rectangle& f = layout.frame;
    const Point outside{f.left - f.width(), f.bottom + f.height()};
    for (std::size_t i = 0; i < series.x.size(); ++i) {
        const double x = series.x[i], y = series.y[i];
        if (!f.contains(layout.point(x, y))) continue;
        if (!series.y_error.empty()) {
            const double e = series.y_error[i];
            draw_error_bar(drawing, finite(layout.point(x, y - e), outside), layout.point(x, y + e),
                           colour, layout.unit, f);
        }
        if (!series.x_error.empty()) {
            const double e = series.x_error[i];
            draw_error_bar(drawing, finite(layout.point(x - e, y), outside), layout.point(x + e, y),
                           colour, layout.unit, f);
        }
    }
}

/// Pieces of a line between points that cannot be drawn.
std::vector<Contour> unbroken_pieces(const Series& series, const PlotLayout& layout)
{
    std::vector<Contour> pieces(1);
    for (std::size_t i = 0; i < series.x.size(); ++i) {
        const Point p = layout.point(series.x[i], series.y[i]);
        if (std::isfinite(p.x) && std::isfinite(p.y))
            pieces.back().push_back(p);
        else if (!pieces.back().empty())
            pieces.emplace_back();
    }
    return pieces;
}

void draw_one(Drawing& drawing, const Series& series, Colour colour, const PlotLayout& layout)
{
    for (const Contour& piece : unbroken_pieces(series, layout))
        draw_line(drawing, piece, series.line, colour, series.line_width * layout.unit,
                  layout.frame);
    draw_error_bars(drawing, series, colour, layout);
    for (std::size_t i = 0; i < series.x.size(); ++i) {
        const Point p = layout.point(series.x[i], series.y[i]);
        if (layout.frame.contains(p)) draw_marker(drawing, series, colour, p, layout.unit);
    }
}

}

Colour cycle_colour(std::size_t index)
{
    return cycle[index % cycle.size()];
}

Colour series_colour(const Plot& plot, std::size_t index)
{
    if (plot.series[index].colour) return *plot.series[index].colour;
    std::size_t earlier = 0;  // series with a colour of their own use none of the cycle
    for (std::size_t i = 0; i < index; ++i) earlier += !plot.series[i].colour.has_value();
    return cycle_colour(earlier);
}

Colour band_colour(const Plot& plot, std::size_t index)
{
    return plot.bands[index].colour.value_or(cycle_colour(index));
}

void draw_sample(Drawing& drawing, const Series& series, Colour colour, Point centre,
                 double line_length, double unit)
{
    draw_line(drawing,
              {{centre.x - line_length / 2, centre.y}, {centre.x + line_length / 2, centre.y}},
              series.line, colour, series.line_width * unit, {});
    const double bar = 17 * unit;
    if (!series.y_error.empty())
        draw_error_bar(drawing, {centre.x, centre.y - bar}, {centre.x, centre.y + bar}, colour,
                       unit, {});
    if (!series.x_error.empty())
        draw_error_bar(drawing, {centre.x - bar, centre.y}, {centre.x + bar, centre.y}, colour,
                       unit, {});
    draw_marker(drawing, series, colour, centre, unit);
}

void draw_spans(Drawing& drawing, const Plot& plot, const PlotLayout& layout)
{
    const Rectangle& f = layout.frame;
    for (const Span& span : plot.spans) {
        const double left = std::max(layout.x.pixel(span.from), f.left);
        const double right = std::min(layout.x.pixel(span.to), f.right);
        if (left < right)
            drawing.fill(
                {{rectangle_contour({left, f.top, right, f.bottom})}, {{230, 230, 232}}, {}});
    }
}

void draw_bands(Drawing& drawing, const Plot& plot, const PlotLayout& layout)
{
    for (std::size_t b = 0; b < plot.bands.size(); ++b) {
        const Band& band = plot.bands[b];
        const double below = layout.frame.bottom + layout.frame.height();
        Contour upper, lower;
        for (std::size_t i = 0; i < band.x.size(); ++i) {
            const Point top = layout.point(band.x[i], band.upper[i]);
            Point bottom = layout.point(band.x[i], band.lower[i]);
            if (!std::isfinite(top.x) || !std::isfinite(top.y)) continue;
            if (!std::isfinite(bottom.y)) bottom.y = below;
            upper.push_back(top);
            lower.push_back(bottom);
        }
        upper.insert(upper.end(), lower.rbegin(), lower.rend());
        drawing.fill({{upper}, {band_colour(plot, b), band_opacity}, {}}, layout.frame);
    }
}

void draw_series(Drawing& drawing, const Plot& plot, const PlotLayout& layout)
{
    for (std::size_t i = 0; i < plot.series.size(); ++i)
        draw_one(drawing, plot.series[i], series_colour(plot, i), layout);
}

}
