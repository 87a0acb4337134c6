// render/triad.cpp -- the three axes as arrows, from wherever the viewer looks.
#include "render/particle_overlay.h"
#include "render/rich_text.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sigmaflow::render {
namespace {

constexpr Colour line_colour{30, 30, 36};
constexpr double triad_font = 26;

struct Arrow {
    Point tip;
    const char* label;
    bool to_viewer;

    double length() const { return std::hypot(tip.x, tip.y); }
    bool is_seen_from_its_end() const { return length() < 0.12; }
};

/// The axes as the viewer sees them, of length 1, y downwards.
std::array<Arrow, 3> seen_axes(const ViewAxes& axes)
{
    const auto arrow = [&](std::size_t d, const char* label) {
        return Arrow{{axes.right[d], -axes.up[d]}, label, axes.away[d] < 0};
    };
    return {arrow(0, "flow $x$"), arrow(1, "gradient $y$"), arrow(2, "vorticity $z$")};
}

/// Where a label stands: its base line, and the rectangle that it fills.
struct LabelPlace {
    Point point;
    Align align;
    Rectangle area;
};

void draw_arrow(Drawing& drawing, Point from, Point to, double unit)
{
    const double length = std::hypot(to.x - from.x, to.y - from.y);
    const Point along{(to.x - from.x) / length, (to.y - from.y) / length};
    const double head = std::min(24 * unit, 0.6 * length), half = 8.5 * unit;
    const Point neck{to.x - head * along.x, to.y - head * along.y};
    const Point notch{to.x - 0.8 * head * along.x, to.y - 0.8 * head * along.y};
    drawing.stroke(
        {.points = {from, notch}, .ink = {line_colour}, .width = 4 * unit, .dashes = {}});
    drawing.fill({{{to,
                    {neck.x - half * along.y, neck.y + half * along.x},
                    notch,
                    {neck.x + half * along.y, neck.y - half * along.x}}},
                  {line_colour},
                  {}});
}

constexpr double triad_length = 128;  // of an arrow across the view, in units of the layout

Point tip_of(const Arrow& arrow, Point origin, double unit)
{
    return {origin.x + triad_length * unit * arrow.tip.x,
            origin.y + triad_length * unit * arrow.tip.y};
}

/// Beyond the tip: above an arrow that points up, right of one that points right, otherwise below.
/// An axis without length has its label below the origin, or left of it if an arrow is there.
LabelPlace label_place(const Arrow& arrow, const std::array<Arrow, 3>& all, Point origin,
                       double unit, double width)
{
    const double size = triad_font * unit, half = width / 2;
    const double capital = capital_height * size, tail = 0.25 * size;
    const auto centred = [&](Point p) {
        return LabelPlace{p, Align::centre, {p.x - half, p.y - capital, p.x + half, p.y + tail}};
    };
    const Point tip = tip_of(arrow, origin, unit), way = arrow.tip;
    if (arrow.is_seen_from_its_end()) {
        const auto points_down = [](const Arrow& a) { return a.tip.y > 0.5; };
        if (std::none_of(all.begin(), all.end(), points_down))
            return centred({origin.x, origin.y + 26 * unit + capital});
        const Point p{origin.x - 26 * unit, origin.y + 0.5 * small_height * size};
        return {p, Align::right, {p.x - width, p.y - capital, p.x, p.y + tail}};
    }
    if (way.y < -std::abs(way.x)) return centred({tip.x, tip.y - 14 * unit});
    if (way.x > std::abs(way.y)) {
        const Point p{tip.x + 12 * unit, tip.y + 0.5 * small_height * size};
        return {p, Align::left, {p.x, p.y - capital, p.x + width, p.y + tail}};
    }
    return centred({tip.x, tip.y + 12 * unit + capital});
}

Rectangle around(const Rectangle& a, const Rectangle& b)
{
    return {std::min(a.left, b.left), std::min(a.top, b.top), std::max(a.right, b.right),
            std::max(a.bottom, b.bottom)};
}

void draw_end_of_axis(Drawing& drawing, Point at, bool to_viewer, double unit)
{
    const double radius = 11 * unit, width = std::max(1., 3 * unit);
    Contour circle = circle_contour(at, radius);
    circle.push_back(circle.front());
    drawing.fill({{circle_contour(at, radius)}, {{255, 255, 255}}, {}});
    drawing.stroke({.points = circle, .ink = {line_colour}, .width = width, .dashes = {}});
    if (to_viewer) {
        drawing.fill({{circle_contour(at, 4.5 * unit)}, {line_colour}, {}});
        return;
    }
    const double arm = radius / std::sqrt(2.);
    for (const double side : {-1., 1.})
        drawing.stroke(
            {.points = {{at.x - arm, at.y - side * arm}, {at.x + arm, at.y + side * arm}},
             .ink = {line_colour},
             .width = width,
             .dashes = {}});
}

}

void draw_triad(Drawing& drawing, const Fonts& fonts, const ParticleLayout& layout,
                const ViewAxes& axes)
{
    const std::array<Arrow, 3> arrows = seen_axes(axes);
    double unit = layout.unit, size = triad_font * unit;
    Point origin{layout.triad.left + 116 * unit, layout.triad.bottom - 92 * unit};
    const auto place = [&](const Arrow& arrow) {
        return label_place(arrow, arrows, origin, unit, text_width(fonts, arrow.label) * size);
    };
    const auto room_for_all = [&] {
        Rectangle all{1e9, 1e9, -1e9, -1e9};
        for (const Arrow& arrow : arrows) all = around(all, place(arrow).area);
        return all;
    };
    // Shrunk and moved until all labels are inside; usually they are. The margins may be used, too.
    const double slack = 14 * unit;
    const Rectangle area{layout.triad.left - slack, layout.triad.top, layout.triad.right - 4 * unit,
                         layout.triad.bottom + slack};
    Rectangle all = room_for_all();
    unit *= std::min({1., area.width() / all.width(), area.height() / all.height()});
    size = triad_font * unit;
    all = room_for_all();
    origin.x -= std::max(0., all.right - area.right);
    origin.x += std::max(0., area.left - room_for_all().left);
    origin.y += std::max(0., area.top - all.top);
    origin.y -= std::max(0., all.bottom - area.bottom);

    for (const Arrow& arrow : arrows) {
        if (arrow.is_seen_from_its_end())
            draw_end_of_axis(drawing, origin, arrow.to_viewer, unit);
        else
            draw_arrow(drawing, origin, tip_of(arrow, origin, unit), unit);
    }
    const auto from_its_end = [](const Arrow& a) { return a.is_seen_from_its_end(); };
    if (std::none_of(arrows.begin(), arrows.end(), from_its_end))
        drawing.fill({{circle_contour(origin, 4.5 * unit)}, {line_colour}, {}});
    for (const Arrow& arrow : arrows) {
        const LabelPlace label = place(arrow);
        draw_text(drawing, fonts, arrow.label, label.point, {.size = size, .align = label.align});
    }
}

}
