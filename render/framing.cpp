// render/framing.cpp
#include "render/framing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sigmaflow::render {
namespace {

double dot(const Position& a, const Position& b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Position minus(const Position& a, const Position& b)
{
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Position plus(const Position& a, double factor, const Position& b)
{
    return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
}

Position cross(const Position& a, const Position& b)
{
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Interval of x/z that a sphere covers, seen from the origin along z: its two tangents.
std::pair<double, double> seen_interval(double x, double z, double radius)
{
    const double direction = std::atan2(x, z);
    const double half = std::asin(std::min(0.99, radius / std::hypot(x, z)));
    return {std::tan(direction - half), std::tan(direction + half)};
}

/// What the spheres cover on the plane at distance 1 in front of the camera.
Rectangle seen(const std::vector<Sphere>& spheres, const Camera& camera)
{
    const ViewAxes& axes = camera.axes;
    const Position eye = camera.position();
    Rectangle r{1e9, 1e9, -1e9, -1e9};
    for (const Sphere& sphere : spheres) {
        const Position p = minus(sphere.centre, eye);
        const double z = dot(p, axes.away);
        const auto [left, right] = seen_interval(dot(p, axes.right), z, sphere.radius);
        const auto [low, high] = seen_interval(dot(p, axes.up), z, sphere.radius);
        r = {std::min(r.left, left), std::min(r.top, low), std::max(r.right, right),
             std::max(r.bottom, high)};
    }
    return r;
}

}

ViewAxes view_axes(const ViewDirection& direction)
{
    const double azimuth = direction.azimuth * std::numbers::pi / 180;
    const double elevation = direction.elevation * std::numbers::pi / 180;
    const double level = std::cos(elevation);
    const Position away{-std::sin(azimuth) * level, -std::sin(elevation),
                        -std::cos(azimuth) * level};
    const Position right{std::cos(azimuth), 0, -std::sin(azimuth)};
    return {right, cross(right, away), away};
}

Position Camera::position() const
{
    return plus(focus, -distance, axes.away);
}

double Camera::view_angle() const
{
    return 2 * std::atan(half_height) * 180 / std::numbers::pi;
}

double Camera::depth(const Position& p) const
{
    return dot(minus(p, position()), axes.away);
}

Point Camera::project(const Position& p) const
{
    const Position seen_from_eye = minus(p, position());
    const double scale = 0.5 * height / (half_height * dot(seen_from_eye, axes.away));
    return {0.5 * width + scale * dot(seen_from_eye, axes.right),
            0.5 * height - scale * dot(seen_from_eye, axes.up)};
}

Camera frame_spheres(const std::vector<Sphere>& spheres, int width, int height,
                     const ViewDirection& direction, double zoom)
{
    Position low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
    double largest_radius = 0;
    for (const Sphere& sphere : spheres) {
        largest_radius = std::max(largest_radius, sphere.radius);
        for (int d = 0; d < 3; ++d) {
            low[d] = std::min(low[d], sphere.centre[d] - sphere.radius);
            high[d] = std::max(high[d], sphere.centre[d] + sphere.radius);
        }
    }
    const Position diagonal = minus(high, low);
    Camera camera{.axes = view_axes(direction)};
    camera.focus = plus(low, 0.5, diagonal);
    // Far enough for a gentle perspective; and VTK's imposters and shadows of spheres are wrong
    // when a sphere is seen from near by.
    camera.distance =
        std::max({1e-6, 2.4 * std::sqrt(dot(diagonal, diagonal)), 50 * largest_radius});

    // Moving the camera sideways changes the perspective a little, so this takes a few rounds.
    const ViewAxes& axes = camera.axes;
    Rectangle area{};
    for (int round = 0; round < 6; ++round) {
        area = seen(spheres, camera);
        camera.focus =
            plus(camera.focus, camera.distance * (area.left + area.right) / 2, axes.right);
        camera.focus = plus(camera.focus, camera.distance * (area.top + area.bottom) / 2, axes.up);
    }
    const double margin = 1.01, half_wide = margin * area.width() / 2;
    const double half_high = margin * area.height() / 2;
    const double pixels = zoom * std::min(width / (2 * half_wide), height / (2 * half_high));
    camera.width = std::clamp(static_cast<int>(std::ceil(2 * half_wide * pixels)), 1, width);
    camera.height = std::clamp(static_cast<int>(std::ceil(2 * half_high * pixels)), 1, height);
    camera.half_height = camera.height / (2 * pixels);
    return camera;
}

}
