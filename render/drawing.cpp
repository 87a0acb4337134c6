// render/drawing.cpp
#include "render/drawing.h"

#include <cmath>
#include <numbers>

namespace sigmaflow::render {

Contour rectangle_contour(const Rectangle& r)
{
    return {{r.left, r.top}, {r.right, r.top}, {r.right, r.bottom}, {r.left, r.bottom}};
}

Contour circle_contour(Point centre, double radius)
{
    const int corners = std::max(12, static_cast<int>(8 * std::sqrt(radius)));
    Contour contour;
    for (int i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * i / corners;
        contour.push_back(
            {centre.x + radius * std::cos(angle), centre.y + radius * std::sin(angle)});
    }
    return contour;
}

std::vector<Contour> dash_pieces(const Contour& points, const std::vector<double>& dashes)
{
    if (dashes.empty()) return {points};
    std::vector<Contour> pieces;
    std::size_t dash = 0;
    double left = dashes[0];
    bool on = true;
    Contour piece;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const Point from = points[i], to = points[i + 1];
        const double length = std::hypot(to.x - from.x, to.y - from.y);
        double done = 0;
        if (on) piece.push_back(from);
        while (length - done > left) {
            done += left;
            const double share = done / length;
            const Point at{from.x + share * (to.x - from.x), from.y + share * (to.y - from.y)};
            if (on) {
                piece.push_back(at);
                pieces.push_back(std::move(piece));
                piece = {};
            } else {
                piece = {at};
            }
            on = !on;
            dash = (dash + 1) % dashes.size();
            left = dashes[dash];
        }
        left -= length - done;
    }
    if (on && !points.empty()) piece.push_back(points.back());
    if (piece.size() > 1) pieces.push_back(std::move(piece));
    return pieces;
}

}
