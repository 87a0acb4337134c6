// render/plot_legend.cpp -- the legend, put where it hides the fewest data.
#include "render/plot_parts.h"
#include "render/rich_text.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow::render {
namespace {

constexpr double sample_length = 62, sample_gap = 18, padding = 16, distance = 24;
constexpr double line_height = 1.42;  // of the font

struct Entry {
    bool is_band;
    std::size_t index;
    std::string label;
};

std::vector<Entry> legend_entries(const Plot& plot)
{
    std::vector<Entry> entries;
    for (std::size_t i = 0; i < plot.series.size(); ++i)
        if (!plot.series[i].label.empty()) entries.push_back({false, i, plot.series[i].label});
    for (std::size_t i = 0; i < plot.bands.size(); ++i)
        if (!plot.bands[i].label.empty()) entries.push_back({true, i, plot.bands[i].label});
    return entries;
}

void add_segment(std::vector<Point>& points, Point a, Point b, const Rectangle& frame)
{
    if (!std::isfinite(a.x + a.y + b.x + b.y)) return;
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    const int steps = std::clamp(static_cast<int>(length / 5), 1, 2000);
    for (int i = 0; i <= steps; ++i) {
        const double t = double(i) / steps;
        const Point p{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
        if (frame.contains(p)) points.push_back(p);
    }
}

/// Points all over the ink that a legend should not hide.
std::vector<Point> drawn_points(const Plot& plot, const PlotLayout& layout)
{
    std::vector<Point> points;
    const auto add_line = [&](const std::vector<double>& x, const std::vector<double>& y,
                              bool connected) {
        for (std::size_t i = 0; i < x.size(); ++i) {
            const Point here = layout.point(x[i], y[i]);
            const Point before = i > 0 && connected ? layout.point(x[i - 1], y[i - 1]) : here;
            add_segment(points, before, here, layout.frame);
        }
    };
    for (const Series& series : plot.series) {
        add_line(series.x, series.y, series.line != Line::none);
        for (std::size_t i = 0; i < series.y_error.size(); ++i)
            add_segment(points, layout.point(series.x[i], series.y[i] - series.y_error[i]),
                        layout.point(series.x[i], series.y[i] + series.y_error[i]), layout.frame);
        for (std::size_t i = 0; i < series.x_error.size(); ++i)
            add_segment(points, layout.point(series.x[i] - series.x_error[i], series.y[i]),
                        layout.point(series.x[i] + series.x_error[i], series.y[i]), layout.frame);
    }
    for (const Band& band : plot.bands) {
        add_line(band.x, band.lower, true);
        add_line(band.x, band.upper, true);
    }
    return points;
}

Rectangle in_corner(Legend corner, double width, double height, const PlotLayout& layout)
{
    const Rectangle& f = layout.frame;
    const double gap = distance * layout.unit;
    const bool left = corner == Legend::top_left || corner == Legend::bottom_left;
    const bool top = corner == Legend::top_left || corner == Legend::top_right;
    const double x = left ? f.left + gap : f.right - gap - width;
    const double y = top ? f.top + gap : f.bottom - gap - height;
    return {x, y, x + width, y + height};
}

/// The corners first, then a grid all over the frame.
std::vector<Rectangle> candidate_places(double width, double height, const PlotLayout& layout)
{
    constexpr int steps = 8;
    std::vector<Rectangle> places;
    for (const Legend corner :
         {Legend::top_right, Legend::top_left, Legend::bottom_right, Legend::bottom_left})
        places.push_back(in_corner(corner, width, height, layout));
    const Rectangle first = in_corner(Legend::top_left, width, height, layout);
    const Rectangle last = in_corner(Legend::bottom_right, width, height, layout);
    for (int row = 0; row <= steps; ++row) {
        for (int column = steps; column >= 0; --column) {
            const double x = first.left + (last.left - first.left) * column / steps;
            const double y = first.top + (last.top - first.top) * row / steps;
            places.push_back({x, y, x + width, y + height});
        }
    }
    return places;
}

bool overlap(const Rectangle& a, const Rectangle& b)
{
    return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}

struct Place {
    Rectangle box;
    bool hides_data;
};

Place legend_place(const Plot& plot, const PlotLayout& layout, const Fonts& fonts, double width,
                   double height)
{
    const std::vector<Point> points = drawn_points(plot, layout);
    const std::vector<Rectangle> labels = span_label_places(plot, layout, fonts);
    const auto cost = [&](const Rectangle& box) {
        const double gap = 8 * layout.unit;  // ink that nearly touches counts, too
        const Rectangle wide{box.left - gap, box.top - gap, box.right + gap, box.bottom + gap};
        long sum =
            std::count_if(points.begin(), points.end(), [&](Point p) { return wide.contains(p); });
        for (const Rectangle& label : labels)
            if (overlap(wide, label)) sum += 1000000;
        return sum;
    };
    if (plot.legend != Legend::best) {
        const Rectangle box = in_corner(plot.legend, width, height, layout);
        return {box, cost(box) > 0};
    }
    Rectangle best{};
    long lowest = -1;
    for (const Rectangle& box : candidate_places(width, height, layout)) {
        const long here = cost(box);
        if (lowest >= 0 && here >= lowest) continue;
        lowest = here;
        best = box;
        if (here == 0) break;
    }
    return {best, lowest > 0};
}

}

void draw_legend(Drawing& drawing, const Plot& plot, const PlotLayout& layout, const Fonts& fonts)
{
    const std::vector<Entry> entries = legend_entries(plot);
    if (plot.legend == Legend::none || entries.empty()) return;
    const double unit = layout.unit, size = 0.94 * layout.tick_font(), line = line_height * size;
    double text = 0;
    for (const Entry& entry : entries) text = std::max(text, text_width(fonts, entry.label) * size);
    const double width = text + (sample_length + sample_gap + 2 * padding) * unit;
    const double height = line * entries.size() + padding * unit;
    const Place place = legend_place(plot, layout, fonts, width, height);

    if (place.hides_data)
        drawing.fill({{rectangle_contour(place.box)}, {{255, 255, 255}, 0.85}, {}});
    double middle = place.box.top + padding * unit / 2 + line / 2;
    const double left = place.box.left + padding * unit;
    for (const Entry& entry : entries) {
        const Point centre{left + sample_length * unit / 2, std::round(middle)};
        if (entry.is_band) {
            const double half = sample_length * unit / 2, high = 0.28 * size;
            drawing.fill({{rectangle_contour({centre.x - half, centre.y - high, centre.x + half,
                                              centre.y + high})},
                          {band_colour(plot, entry.index), 1.4 * band_opacity},
                          {}});
        } else {
            draw_sample(drawing, plot.series[entry.index], series_colour(plot, entry.index), centre,
                        sample_length * unit, unit);
        }
        draw_text(
            drawing, fonts, entry.label,
            {left + (sample_length + sample_gap) * unit, centre.y + 0.5 * small_height * size},
            {.size = size});
        middle += line;
    }
}

}
