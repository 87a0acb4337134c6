// render/rasterise.cpp -- scan conversion by the nonzero winding rule.
//
// Each row of pixels is cut into thin scan lines. On a scan line the covered intervals are found
// exactly, so that vertical edges are smooth without limit and horizontal ones in `lines_per_row`
// steps.
#include "render/drawing.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow::render {
namespace {

constexpr int lines_per_row = 16;

struct Crossing {
    double x;
    int direction;
};

/// Where the contours cross every scan line of the rows [first_row, last_row).
class Crossings {
public:
    Crossings(const std::vector<Contour>& contours, int first_row, int last_row)
        : first_line_(first_row * lines_per_row),
          lines_(static_cast<std::size_t>(last_row - first_row) * lines_per_row)
    {
        for (const Contour& contour : contours)
            for (std::size_t i = 0; i < contour.size(); ++i)
                add_edge(contour[i], contour[(i + 1) % contour.size()]);
        for (auto& line : lines_)
            std::sort(line.begin(), line.end(),
                      [](const Crossing& a, const Crossing& b) { return a.x < b.x; });
    }

    const std::vector<Crossing>& line(int number) const { return lines_[number - first_line_]; }

private:
    void add_edge(Point from, Point to)
    {
        const int direction = to.y > from.y ? 1 : -1;
        if (direction < 0) std::swap(from, to);
        const double end = first_line_ + static_cast<double>(lines_.size());
        const double top = std::max<double>(first_line_, from.y * lines_per_row - 0.5);
        const double bottom = std::min(end, to.y * lines_per_row - 0.5);
        for (int line = static_cast<int>(std::ceil(top)); line < bottom; ++line) {
            const double y = (line + 0.5) / lines_per_row;
            const double x = from.x + (to.x - from.x) * (y - from.y) / (to.y - from.y);
            lines_[line - first_line_].push_back({x, direction});
        }
    }

    int first_line_;
    std::vector<std::vector<Crossing>> lines_;
};

/// Adds the part of every pixel that lies in [from, to].
void add_interval(std::vector<float>& coverage, double from, double to)
{
    const int first = static_cast<int>(from);
    const int last = std::min(static_cast<int>(to), static_cast<int>(coverage.size()) - 1);
    if (first == last) {
        coverage[first] += static_cast<float>(to - from);
        return;
    }
    coverage[first] += static_cast<float>(first + 1 - from);
    for (int column = first + 1; column < last; ++column) coverage[column] += 1;
    coverage[last] += static_cast<float>(to - last);
}

void add_line(std::vector<float>& coverage, const std::vector<Crossing>& crossings, double left,
              double right)
{
    int winding = 0;
    double start = 0;
    for (const Crossing& crossing : crossings) {
        const int before = winding;
        winding += crossing.direction;
        if (before == 0) {
            start = crossing.x;
        } else if (winding == 0) {
            const double from = std::max(start, left), to = std::min(crossing.x, right);
            if (from < to) add_interval(coverage, from, to);
        }
    }
}

void blend(std::uint8_t* pixel, const Ink& ink, double share)
{
    for (int channel = 0; channel < 3; ++channel) {
        const double mixed = pixel[channel] + share * (ink.colour[channel] - pixel[channel]);
        pixel[channel] = static_cast<std::uint8_t>(std::lround(mixed));
    }
}

void fill_contours(Image& image, const std::vector<Contour>& contours, const Ink& ink,
                   const Rectangle& clip)
{
    double top = clip.bottom, bottom = clip.top;
    for (const Contour& contour : contours) {
        for (const Point& p : contour) {
            if (!std::isfinite(p.x) || !std::isfinite(p.y)) return;
            top = std::min(top, p.y);
            bottom = std::max(bottom, p.y);
        }
    }
    const int first_row = static_cast<int>(std::floor(std::max(top, clip.top)));
    const int last_row = static_cast<int>(std::ceil(std::min(bottom, clip.bottom)));
    if (first_row >= last_row) return;

    const Crossings crossings(contours, first_row, last_row);
    std::vector<float> coverage(image.width);
    for (int row = first_row; row < last_row; ++row) {
        std::fill(coverage.begin(), coverage.end(), 0.0f);
        for (int line = row * lines_per_row; line < (row + 1) * lines_per_row; ++line) {
            const double y = (line + 0.5) / lines_per_row;
            if (y > clip.top && y < clip.bottom)
                add_line(coverage, crossings.line(line), clip.left, clip.right);
        }
        for (int column = 0; column < image.width; ++column)
            if (coverage[column] > 0)
                blend(image.pixel(column, row), ink,
                      ink.opacity * std::min(1.0f, coverage[column] / lines_per_row));
    }
}

/// Points closer than a fraction of a pixel tell nothing: long series become short.
Contour thinned(const Contour& points)
{
    Contour kept;
    for (const Point& p : points)
        if (kept.empty() || std::hypot(p.x - kept.back().x, p.y - kept.back().y) > 0.25)
            kept.push_back(p);
    if (kept.size() == 1 && points.size() > 1) kept.push_back(points.back());
    return kept;
}

/// Do bars of this half width leave a visible notch where they meet?
bool opens_a_gap(Point before, Point at, Point after, double radius)
{
    const double ux = at.x - before.x, uy = at.y - before.y;
    const double vx = after.x - at.x, vy = after.y - at.y;
    const double turn = std::atan2(ux * vy - uy * vx, ux * vx + uy * vy);
    return radius * std::abs(turn) > 0.1;  // [pixels]
}

/// A bar around every segment and a disc on every joint. All run the same way round, so that they
/// add up by the winding rule.
void add_outline(std::vector<Contour>& contours, const Contour& line, double width, bool round)
{
    const double radius = width / 2;
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        const Point a = line[i], b = line[i + 1];
        const double length = std::hypot(b.x - a.x, b.y - a.y);
        if (length == 0) continue;
        const Point n{-radius * (b.y - a.y) / length, radius * (b.x - a.x) / length};
        contours.push_back({{a.x - n.x, a.y - n.y},
                            {b.x - n.x, b.y - n.y},
                            {b.x + n.x, b.y + n.y},
                            {a.x + n.x, a.y + n.y}});
    }
    for (std::size_t i = 0; i < line.size(); ++i) {
        const bool is_end = i == 0 || i + 1 == line.size();
        if (is_end ? round : opens_a_gap(line[i - 1], line[i], line[i + 1], radius))
            contours.push_back(circle_contour(line[i], radius));
    }
}

std::vector<Contour> outline(const Stroke& stroke)
{
    std::vector<Contour> contours;
    for (const Contour& piece : dash_pieces(thinned(stroke.points), stroke.dashes))
        add_outline(contours, piece, stroke.width, stroke.round);
    return contours;
}

}

void rasterise(const Drawing& drawing, Image& image)
{
    const Rectangle whole{0, 0, double(image.width), double(image.height)};
    for (const Shape& shape : drawing.shapes) {
        Rectangle clip = shape.clip.value_or(whole);
        clip = {std::max(clip.left, whole.left), std::max(clip.top, whole.top),
                std::min(clip.right, whole.right), std::min(clip.bottom, whole.bottom)};
        if (const Fill* fill = std::get_if<Fill>(&shape.form)) {
            fill_contours(image, fill->contours, fill->ink, clip);
        } else {
            const Stroke& stroke = std::get<Stroke>(shape.form);
            fill_contours(image, outline(stroke), stroke.ink, clip);
        }
    }
}

}
