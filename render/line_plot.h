// render/line_plot.h -- plots for a paper: lines, markers, error bars, bands, reference lines, and
// fields of two variables as coloured cells with a colour bar.
//
// Texts are rich: $italic$ letters, _{subscript}, ^{superscript}, any Unicode (DejaVu fonts).
// No graphics driver is needed. Errors: rendering (a font is missing), input (series of unequal
// length, bad range, cells that do not fit their edges).
#pragma once
#include "render/image.h"

#include <optional>
#include <string>
#include <vector>

namespace sigmaflow::render {

enum class Line { none, solid, dashed, dotted };
enum class Marker { none, circle, square, triangle, diamond, cross };

struct Series {
    std::string label;                     // empty: not in the legend
    std::vector<double> x, y;              // NaN breaks the line
    std::vector<double> x_error, y_error;  // empty or one per point
    Line line = Line::solid;
    Marker marker = Marker::none;
    bool open_marker = false;
    double line_width = 2.5;       // [pixels at height 1080]
    std::optional<Colour> colour;  // default: next of a colour-blind safe cycle
};

/// Shaded strip lower <= y <= upper.
struct Band {
    std::string label;
    std::vector<double> x, lower, upper;
    std::optional<Colour> colour;
};

/// Shaded x range, e.g. the start-up that is left out, with a label at its top.
struct Span {
    double from, to;
    std::string label;
};

/// Cells between edges, coloured by their values; below all lines, with a bar on the right.
struct ColourGrid {
    std::vector<double> x, y;    // edges of the cells, ascending; at least 2 each
    std::vector<double> values;  // (x.size() - 1) (y.size() - 1), row by row along x; NaN: grey
    std::string map = "viridis", label;
    double minimum = 0, maximum = 1;  // of the colours; values outside have the end colours
};

struct PlotAxis {
    std::string title;
    std::optional<double> minimum, maximum;  // default: from the data with a margin
    bool logarithmic = false;
};

enum class Legend { none, best, top_left, top_right, bottom_left, bottom_right };

struct Plot {
    int width = 1920, height = 1080;
    std::string title;
    PlotAxis x, y;
    std::vector<Series> series;
    std::vector<Band> bands;
    std::vector<Span> spans;
    std::optional<ColourGrid> grid;
    Legend legend = Legend::best;
};

/// The colours that series and bands without one of their own take in turns.
Colour cycle_colour(std::size_t index);

Image render_plot(const Plot& plot);
std::string plot_svg(const Plot& plot);

}
