// render/framing.h -- where the camera stands so that everything is seen and nothing is wasted.
#pragma once
#include "render/drawing.h"

#include <array>
#include <vector>

namespace sigmaflow::render {

using Position = std::array<double, 3>;

struct Sphere {
    Position centre{};
    double radius = 0;
};

/// A camera that looks at `focus` from `distance` away. The view is fixed: flow (x) to the right,
/// gradient (y) upwards, seen from the front (+z), a little from the right and from above.
struct Camera {
    Position focus{};
    double distance = 1;
    double half_height = 1;     // tangent of half the vertical view angle
    int width = 1, height = 1;  // picture [pixels]

    Position position() const;
    double view_angle() const;               // vertical [degrees]
    double depth(const Position& p) const;   // distance in front of the camera along its axis
    Point project(const Position& p) const;  // to pixels from the top left corner
};

/// Directions of the view in space: to the right, up, and away from the viewer.
struct ViewAxes {
    Position right, up, away;
};
ViewAxes view_axes();

/// The camera whose picture of at most width x height pixels is filled by the spheres (the corners
/// of a box are spheres of radius 0), and cut to them in the direction that has room to spare.
/// At least one sphere.
Camera frame_spheres(const std::vector<Sphere>& spheres, int width, int height);

}
