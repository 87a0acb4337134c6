// render/plot_parts.h -- the pieces of a line plot; only line_plot.cpp and plot_*.cpp use them.
#pragma once
#include "render/drawing.h"
#include "render/fonts.h"
#include "render/line_plot.h"
#include "render/ticks.h"

#include <vector>

namespace sigmaflow::render {

inline constexpr Colour frame_colour{20, 20, 26};

/// One axis: from data to pixels.
struct Scale {
    Range range{0, 1};
    bool logarithmic = false;
    double first_pixel = 0, last_pixel = 1;  // of range.from and range.to

    /// Far outside the frame the result is held at some 1e5 pixels; NaN stays NaN, and so does a
    /// value that a logarithmic axis cannot show.
    double pixel(double value) const;
    std::vector<Tick> ticks() const;
};

/// Where everything is. `unit` scales the sizes that are given for a picture 1080 pixels high.
struct PlotLayout {
    double unit = 1;
    Rectangle frame;
    Rectangle colour_bar;  // of a grid
    Scale x, y;

    double tick_font() const { return 32 * unit; }
    double title_font() const { return 37 * unit; }
    Point point(double data_x, double data_y) const { return {x.pixel(data_x), y.pixel(data_y)}; }
};

PlotLayout plot_layout(const Plot& plot, const Fonts& fonts);

void draw_grid(Drawing& drawing, const Plot& plot, const PlotLayout& layout, const Fonts& fonts);
void draw_spans(Drawing& drawing, const Plot& plot, const PlotLayout& layout);
void draw_bands(Drawing& drawing, const Plot& plot, const PlotLayout& layout);
void draw_series(Drawing& drawing, const Plot& plot, const PlotLayout& layout);
void draw_axes(Drawing& drawing, const Plot& plot, const PlotLayout& layout, const Fonts& fonts);
void draw_span_labels(Drawing& drawing, const Plot& plot, const PlotLayout& layout,
                      const Fonts& fonts);
void draw_legend(Drawing& drawing, const Plot& plot, const PlotLayout& layout, const Fonts& fonts);

/// Samples of a series as it appears in the legend: line, error bar and marker around `centre`.
void draw_sample(Drawing& drawing, const Series& series, Colour colour, Point centre,
                 double line_length, double unit);

Colour series_colour(const Plot& plot, std::size_t index);
Colour band_colour(const Plot& plot, std::size_t index);
inline constexpr double band_opacity = 0.22;

/// Rectangles of the labels of the shaded spans.
std::vector<Rectangle> span_label_places(const Plot& plot, const PlotLayout& layout,
                                         const Fonts& fonts);

}
