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

/// From where the viewer looks at the box [degrees]. Azimuth, about the gradient axis: 0 from the
/// front (+z), 90 from the right (+x), any number. Elevation above the flow-vorticity plane, in
/// [-90, 90]. The default is from the front, a little from the right and from above.
struct ViewDirection {
    double azimuth = 22.78240573048169, elevation = 14.969290468689584;
};

/// Directions of the view in space: to the right, up, and away from the viewer. The gradient axis
/// (y) never leans to a side.
struct ViewAxes {
    Position right, up, away;
};
ViewAxes view_axes(const ViewDirection& direction = {});

/// A camera that looks at `focus` from `distance` away.
struct Camera {
    ViewAxes axes = view_axes();
    Position focus{};
    double distance = 1;
    double half_height = 1;     // tangent of half the vertical view angle
    int width = 1, height = 1;  // picture [pixels]

    Position position() const;
    double view_angle() const;               // vertical [degrees]
    double depth(const Position& p) const;   // distance in front of the camera along its axis
    Point project(const Position& p) const;  // to pixels from the top left corner
};

/// The camera whose picture of at most width x height pixels is filled by the spheres (the corners
/// of a box are spheres of radius 0), and cut to them in the direction that has room to spare.
/// At least one sphere. `zoom` enlarges the middle of that; what then lies outside is cut off.
Camera frame_spheres(const std::vector<Sphere>& spheres, int width, int height,
                     const ViewDirection& direction = {}, double zoom = 1);

}
