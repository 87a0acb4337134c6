// tests/render/framing_test.cpp
#include "render/framing.h"

#include <gtest/gtest.h>
#include <cmath>

using namespace sigmaflow::render;

namespace {

/// Points all over the surfaces of the spheres.
std::vector<Position> surface_points(const std::vector<Sphere>& spheres)
{
    std::vector<Position> points;
    for (const Sphere& s : spheres) {
        for (int i = 0; i < 400; ++i) {
            const double z = -1 + (i + 0.5) / 200, phi = 2.399963 * i, rho = std::sqrt(1 - z * z);
            points.push_back({s.centre[0] + s.radius * rho * std::cos(phi),
                              s.centre[1] + s.radius * rho * std::sin(phi),
                              s.centre[2] + s.radius * z});
        }
    }
    return points;
}

std::vector<Sphere> corner_spheres(double x, double y, double z, double radius)
{
    std::vector<Sphere> spheres;
    for (int corner = 0; corner < 8; ++corner)
        spheres.push_back({{corner & 1 ? x : 0, corner & 2 ? y : 0, corner & 4 ? z : 0}, radius});
    return spheres;
}

}

TEST(Framing, EverythingIsSeenAndNothingIsWasted)
{
    const double shapes[][3] = {{10, 10, 10}, {40, 10, 10}, {10, 50, 10}, {10, 10, 80}, {1, 1, 1}};
    for (const auto& [x, y, z] : shapes) {
        SCOPED_TRACE(testing::Message() << x << " x " << y << " x " << z);
        const std::vector<Sphere> spheres = corner_spheres(x, y, z, 1.3);
        const Camera camera = frame_spheres(spheres, 900, 600);
        EXPECT_TRUE(camera.width == 900 || camera.height == 600);
        Rectangle seen{1e9, 1e9, -1e9, -1e9};
        for (const Position& p : surface_points(spheres)) {
            const Point at = camera.project(p);
            seen = {std::min(seen.left, at.x), std::min(seen.top, at.y), std::max(seen.right, at.x),
                    std::max(seen.bottom, at.y)};
        }
        EXPECT_GE(seen.left, 0);
        EXPECT_GE(seen.top, 0);
        EXPECT_LE(seen.right, camera.width);
        EXPECT_LE(seen.bottom, camera.height);
        EXPECT_GT(seen.width(), 0.97 * camera.width);
        EXPECT_GT(seen.height(), 0.97 * camera.height);
    }
}

TEST(Framing, FlowPointsRightGradientUpAndVorticityToTheViewer)
{
    const Camera camera = frame_spheres(corner_spheres(10, 10, 10, 1), 500, 500);
    const Position centre{5, 5, 5};
    const Point origin = camera.project(centre);
    EXPECT_GT(camera.project({6, 5, 5}).x, origin.x);
    EXPECT_LT(camera.project({5, 6, 5}).y, origin.y);
    EXPECT_NEAR(camera.project({5, 6, 5}).x, origin.x, 0.5);
    EXPECT_LT(camera.depth({5, 5, 6}), camera.depth(centre));
}

TEST(Framing, TheViewDoesNotDependOnWhereTheBoxLies)
{
    std::vector<Sphere> spheres = corner_spheres(10, 12, 14, 1);
    const Camera here = frame_spheres(spheres, 640, 480);
    for (Sphere& s : spheres)
        for (int d = 0; d < 3; ++d) s.centre[d] += 1000 * (d + 1);
    const Camera there = frame_spheres(spheres, 640, 480);
    const Point a = here.project({3, 4, 5}), b = there.project({1003, 2004, 3005});
    EXPECT_NEAR(a.x, b.x, 1e-6);
    EXPECT_NEAR(a.y, b.y, 1e-6);
}

TEST(Framing, NamedDirectionsShowTheirPlanes)
{
    // right and up of the picture: which axis, which sign
    struct Case {
        ViewDirection direction;
        Position right, up;
    };
    for (const auto& [direction, right, up] :
         {Case{{0, 0}, {1, 0, 0}, {0, 1, 0}}, Case{{90, 0}, {0, 0, -1}, {0, 1, 0}},
          Case{{0, 90}, {1, 0, 0}, {0, 0, -1}}, Case{{180, 0}, {-1, 0, 0}, {0, 1, 0}},
          Case{{0, -90}, {1, 0, 0}, {0, 0, 1}}}) {
        const ViewAxes axes = view_axes(direction);
        for (std::size_t d = 0; d < 3; ++d) {
            EXPECT_NEAR(axes.right[d], right[d], 1e-15) << direction.azimuth;
            EXPECT_NEAR(axes.up[d], up[d], 1e-15) << direction.elevation;
        }
    }
    const ViewAxes iso = view_axes({45, std::atan(std::sqrt(0.5)) * 180 / M_PI});
    for (std::size_t d = 0; d < 3; ++d)  // along the diagonal of a cube
        EXPECT_NEAR(iso.away[d], -1 / std::sqrt(3.), 1e-15);
}

TEST(Framing, EverythingIsSeenFromEveryDirection)
{
    const std::vector<Sphere> spheres = corner_spheres(10, 14, 8, 1.2);
    for (double azimuth = -180; azimuth < 180; azimuth += 33)
        for (double elevation : {-90., -50., 0., 35., 90.}) {
            const Camera camera = frame_spheres(spheres, 300, 200, {azimuth, elevation});
            for (const Position& p : surface_points(spheres)) {
                const Point at = camera.project(p);
                ASSERT_TRUE(at.x >= 0 && at.y >= 0 && at.x <= camera.width && at.y <= camera.height)
                    << azimuth << " " << elevation;
            }
        }
}

TEST(Framing, ZoomEnlargesAboutTheMiddle)
{
    const std::vector<Sphere> spheres = corner_spheres(10, 10, 10, 1);
    const Camera plain = frame_spheres(spheres, 500, 500);
    for (double zoom : {0.5, 2.0, 7.0}) {
        const Camera near = frame_spheres(spheres, 500, 500, {}, zoom);
        EXPECT_LE(near.width, 500);
        EXPECT_LE(near.height, 500);
        const Point a = plain.project({5.5, 4, 6}), b = near.project({5.5, 4, 6});
        EXPECT_NEAR(b.x - 0.5 * near.width, zoom * (a.x - 0.5 * plain.width), 1e-9);
        EXPECT_NEAR(b.y - 0.5 * near.height, zoom * (a.y - 0.5 * plain.height), 1e-9);
    }
}

TEST(Framing, ViewAxesAreARightHandedOrthonormalSet)
{
    const ViewAxes axes = view_axes();
    const auto dot = [](const Position& a, const Position& b) {
        return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    };
    EXPECT_NEAR(dot(axes.right, axes.right), 1, 1e-14);
    EXPECT_NEAR(dot(axes.up, axes.up), 1, 1e-14);
    EXPECT_NEAR(dot(axes.away, axes.away), 1, 1e-14);
    EXPECT_NEAR(dot(axes.right, axes.up), 0, 1e-14);
    EXPECT_NEAR(dot(axes.right, axes.away), 0, 1e-14);
    EXPECT_NEAR(axes.right[0] * axes.up[1] - axes.right[1] * axes.up[0], -axes.away[2], 1e-14);
}
