// render/plot_axes.cpp -- frame, ticks, tick labels, axis titles, labels of shaded spans.
#include "render/plot_parts.h"
#include "render/rich_text.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow::render {
namespace {

constexpr double major_length = 15, minor_length = 8, major_width = 2.2, minor_width = 1.6;
constexpr double label_gap = 14;

double whole_pixels(double width)
{
    return std::max(1.0, std::round(width));
}

/// A centre line such that a line of this width covers whole pixels.
double sharp(double position, double width)
{
    return std::lround(width) % 2 == 0 ? std::round(position) : std::floor(position) + 0.5;
}

void draw_frame(Drawing& drawing, const PlotLayout& layout)
{
    const double width = whole_pixels(major_width * layout.unit);
    const Rectangle& f = layout.frame;
    const double left = sharp(f.left, width), right = sharp(f.right, width);
    const double top = sharp(f.top, width), bottom = sharp(f.bottom, width);
    drawing.stroke({.points = {{left, top},
                               {right, top},
                               {right, bottom},
                               {left, bottom},
                               {left, top},
                               {right, top}},
                    .ink = {frame_colour},
                    .width = width,
                    .dashes = {}});
}

void draw_ticks(Drawing& drawing, const PlotLayout& layout, bool vertical)
{
    const Rectangle& f = layout.frame;
    const Scale& scale = vertical ? layout.y : layout.x;
    for (const Tick& tick : scale.ticks()) {
        const bool major = !tick.label.empty();
        const double length = (major ? major_length : minor_length) * layout.unit;
        const double width = whole_pixels((major ? major_width : minor_width) * layout.unit);
        const double at = sharp(scale.pixel(tick.value), width);
        const auto draw = [&](Point from, Point to) {
            drawing.stroke(
                {.points = {from, to}, .ink = {frame_colour}, .width = width, .dashes = {}});
        };
        if (vertical) {
            draw({f.left, at}, {f.left + length, at});
            draw({f.right, at}, {f.right - length, at});
        } else {
            draw({at, f.bottom}, {at, f.bottom - length});
            draw({at, f.top}, {at, f.top + length});
        }
    }
}

void draw_x_labels(Drawing& drawing, const PlotLayout& layout, const Fonts& fonts)
{
    const double size = layout.tick_font();
    const double base = layout.frame.bottom + label_gap * layout.unit + capital_height * size;
    double free_from = -1e9;
    for (const Tick& tick : layout.x.ticks()) {
        if (tick.label.empty()) continue;
        const double centre = layout.x.pixel(tick.value);
        const double half = 0.5 * size * text_width(fonts, tick.label);
        if (centre - half < free_from) continue;  // would touch its neighbour
        draw_text(drawing, fonts, tick.label, {centre, base},
                  {.size = size, .align = Align::centre});
        free_from = centre + half + 0.4 * size;
    }
}

void draw_y_labels(Drawing& drawing, const PlotLayout& layout, const Fonts& fonts)
{
    const double size = layout.tick_font();
    for (const Tick& tick : layout.y.ticks())
        draw_text(drawing, fonts, tick.label,
                  {layout.frame.left - label_gap * layout.unit,
                   layout.y.pixel(tick.value) + 0.5 * capital_height * size},
                  {.size = size, .align = Align::right});
}

/// A long title is set smaller rather than cut.
double fitting_size(const Fonts& fonts, const std::string& text, double size, double room)
{
    const double width = text_width(fonts, text) * size;
    return width > room ? size * room / width : size;
}

void draw_titles(Drawing& drawing, const Plot& plot, const PlotLayout& layout, const Fonts& fonts)
{
    const Rectangle& f = layout.frame;
    const double size = layout.title_font();
    const double centre_x = (f.left + f.right) / 2, centre_y = (f.top + f.bottom) / 2;
    const double wide = 2 * std::min(centre_x, plot.width - centre_x);
    const double high = 2 * std::min(centre_y, plot.height - centre_y);
    draw_text(drawing, fonts, plot.x.title, {centre_x, plot.height - 26 * layout.unit},
              {.size = fitting_size(fonts, plot.x.title, size, wide), .align = Align::centre});
    draw_text(drawing, fonts, plot.y.title, {20 * layout.unit + size, centre_y},
              {.size = fitting_size(fonts, plot.y.title, size, high),
               .align = Align::centre,
               .upwards = true});
    draw_text(drawing, fonts, plot.title, {centre_x, f.top - 0.55 * size},
              {.size = fitting_size(fonts, plot.title, size, wide), .align = Align::centre});
}

struct SpanLabel {
    Point at;
    double size;
    bool upwards;
    Rectangle place;
};

/// Lying in the middle of its span if that is wide enough, otherwise standing along its left edge.
SpanLabel span_label(const Span& span, const PlotLayout& layout, const Fonts& fonts)
{
    const Rectangle& f = layout.frame;
    const double size = 0.85 * layout.tick_font(), top = f.top + 26 * layout.unit;
    const double left = std::clamp(layout.x.pixel(span.from), f.left, f.right);
    const double right = std::clamp(layout.x.pixel(span.to), f.left, f.right);
    const double width = size * text_width(fonts, span.label), centre = (left + right) / 2;
    if (width + 0.8 * size < right - left) {
        const double base = top + capital_height * size;
        return {{centre, base},
                size,
                false,
                {centre - width / 2, top, centre + width / 2, base + 0.3 * size}};
    }
    const double base = std::max(centre + 0.5 * capital_height * size,
                                 left + 22 * layout.unit + capital_height * size);
    return {{base, top + width}, size, true, {base - size, top, base + 0.3 * size, top + width}};
}

}

std::vector<Rectangle> span_label_places(const Plot& plot, const PlotLayout& layout,
                                         const Fonts& fonts)
{
    std::vector<Rectangle> places;
    for (const Span& span : plot.spans)
        if (!span.label.empty()) places.push_back(span_label(span, layout, fonts).place);
    return places;
}

void draw_span_labels(Drawing& drawing, const Plot& plot, const PlotLayout& layout,
                      const Fonts& fonts)
{
    for (const Span& span : plot.spans) {
        const SpanLabel label = span_label(span, layout, fonts);
        draw_text(drawing, fonts, span.label, label.at,
                  {.size = label.size,
                   .align = label.upwards ? Align::left : Align::centre,
                   .ink = {{90, 90, 96}},
                   .upwards = label.upwards});
    }
}

void draw_axes(Drawing& drawing, const Plot& plot, const PlotLayout& layout, const Fonts& fonts)
{
    draw_frame(drawing, layout);
    draw_ticks(drawing, layout, false);
    draw_ticks(drawing, layout, true);
    draw_x_labels(drawing, layout, fonts);
    draw_y_labels(drawing, layout, fonts);
    draw_titles(drawing, plot, layout, fonts);
}

}
