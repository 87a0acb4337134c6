// render/drawing.h -- flat pictures as a list of shapes: what plots, colour bars and titles are
// made of.
//
// The same list becomes pixels (rasterise) or an SVG file (svg_text); neither needs any graphics
// system, so both look the same everywhere. Coordinates are pixels, x to the right, y downwards
// from the top left corner of the picture; texts arrive as outlines.
#pragma once
#include "render/image.h"

#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace sigmaflow::render {

struct Point {
    double x = 0, y = 0;
};

struct Rectangle {
    double left = 0, top = 0, right = 0, bottom = 0;

    double width() const { return right - left; }
    double height() const { return bottom - top; }
    bool contains(Point p) const
    {
        return p.x >= left && p.x <= right && p.y >= top && p.y <= bottom;
    }
};

using Contour = std::vector<Point>;

struct Ink {
    Colour colour{0, 0, 0};
    double opacity = 1;  // [0, 1]
};

/// Everything inside closed contours, by the nonzero winding rule (holes run the other way round).
struct Fill {
    std::vector<Contour> contours;
    Ink ink;
    std::string text;  // not empty: the outlines spell this text
};

/// A line along points.
struct Stroke {
    Contour points;
    Ink ink;
    double width = 1;            // [pixels]
    std::vector<double> dashes;  // lengths on, off, on, ... [pixels]; empty: solid
    bool round = false;          // ends
};

struct Shape {
    std::variant<Fill, Stroke> form;
    std::optional<Rectangle> clip;
};

struct Drawing {
    int width = 0, height = 0;
    std::vector<Shape> shapes;  // later ones lie on top

    void fill(Fill shape, std::optional<Rectangle> clip = {})
    {
        shapes.push_back({std::move(shape), clip});
    }
    void stroke(Stroke shape, std::optional<Rectangle> clip = {})
    {
        shapes.push_back({std::move(shape), clip});
    }
};

Contour rectangle_contour(const Rectangle& rectangle);
Contour circle_contour(Point centre, double radius);

/// Pieces of a line that are on, after cutting it into dashes.
std::vector<Contour> dash_pieces(const Contour& points, const std::vector<double>& dashes);

/// Draws onto an image of the same size, edges smoothed by exact horizontal coverage.
void rasterise(const Drawing& drawing, Image& image);

/// The drawing on a white background.
std::string svg_text(const Drawing& drawing);

}
