// tests/render/particles_test.cpp -- facts about pictures of spheres that no driver may change, and
// a comparison with a baseline.
#include "render/particles.h"

#include "engine/error.h"
#include "render/colour_map.h"
#include "render/framing.h"
#include "render/particle_overlay.h"
#include "tests/render/scenes.h"
#include "tests/support/image_compare.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>

using namespace sigmaflow;
using render::Colour;
using render::Image;
using render::ParticleView;
using test::Ball;

namespace {

bool is_white(const std::uint8_t* pixel)
{
    return pixel[0] + pixel[1] + pixel[2] >= 3 * 252;
}

/// Areas [pixels] of the connected regions that are not white.
std::vector<int> blob_areas(const Image& image)
{
    std::vector<char> seen(std::size_t(image.width) * image.height, 0);
    std::vector<int> areas;
    for (int start = 0; start < image.width * image.height; ++start) {
        if (seen[start] || is_white(&image.rgb[3 * start])) continue;
        std::vector<int> open{start};
        seen[start] = 1;
        int area = 0;
        while (!open.empty()) {
            const int at = open.back(), x = at % image.width, y = at / image.width;
            open.pop_back();
            ++area;
            for (const auto& [dx, dy] : {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
                const int nx = x + dx, ny = y + dy, next = ny * image.width + nx;
                if (nx < 0 || ny < 0 || nx >= image.width || ny >= image.height || seen[next] ||
                    is_white(&image.rgb[3 * next]))
                    continue;
                seen[next] = 1;
                open.push_back(next);
            }
        }
        areas.push_back(area);
    }
    std::sort(areas.begin(), areas.end());
    return areas;
}

render::Rectangle ink_bounds(const Image& image)
{
    render::Rectangle r{1e9, 1e9, -1, -1};
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            if (!is_white(image.pixel(x, y)))
                r = {std::min<double>(r.left, x), std::min<double>(r.top, y),
                     std::max<double>(r.right, x + 1), std::max<double>(r.bottom, y + 1)};
    return r;
}

/// Angle [degrees] between two colours as directions in RGB space: how different their tints are,
/// whatever the light.
double tint_difference(const std::uint8_t* pixel, const Colour& colour)
{
    double dot = 0, a = 0, b = 0;
    for (int c = 0; c < 3; ++c) {
        dot += double(pixel[c]) * colour[c];
        a += double(pixel[c]) * pixel[c];
        b += double(colour[c]) * colour[c];
    }
    return std::acos(std::min(1.0, dot / std::sqrt(a * b))) * 180 / M_PI;
}

/// Positions given along the axes of the view, so that depth and overlap are plain to see.
std::array<double, 3> in_view(double right, double up, double away)
{
    const render::ViewAxes axes = render::view_axes();
    std::array<double, 3> p{};
    for (int d = 0; d < 3; ++d)
        p[d] = right * axes.right[d] + up * axes.up[d] + away * axes.away[d];
    return p;
}

/// Where a bare picture shows a point: it is framed tightly and centred.
std::pair<int, int> pixel_of(const std::vector<Ball>& balls, const ParticleView& view,
                             const std::array<double, 3>& point)
{
    std::vector<render::Sphere> spheres;
    for (const Ball& ball : balls) spheres.push_back({ball.centre, ball.radius});
    const render::Rectangle room =
        render::particle_layout(view.width, view.height, false, false, false).particles;
    const int width = static_cast<int>(room.width()), height = static_cast<int>(room.height());
    const render::Camera camera = render::frame_spheres(spheres, width, height);
    const render::Point p = camera.project(point);
    return {static_cast<int>((view.width - camera.width) / 2.0 + p.x),
            static_cast<int>((view.height - camera.height) / 2.0 + p.y)};
}

}

TEST(Particles, EveryFreeSphereIsOneDisc)
{
    std::vector<Ball> balls;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 3; ++j) balls.push_back({in_view(3.0 * i, 3.0 * j, 0), 1.0, 0.5});
    const Image image = render::render_particles(test::polydata(balls), test::bare_view(400, 320));
    EXPECT_EQ(blob_areas(image).size(), 12u);
}

TEST(Particles, AreasOfDiscsFollowTheRadii)
{
    const std::vector<Ball> balls{{in_view(-1.6, 0, 0), 1.0, 0.5}, {in_view(1.6, 0, 0), 1.4, 0.5}};
    const Image image = render::render_particles(test::polydata(balls), test::bare_view(500, 400));
    const std::vector<int> areas = blob_areas(image);
    ASSERT_EQ(areas.size(), 2u);
    EXPECT_NEAR(double(areas[1]) / areas[0], 1.4 * 1.4, 0.05);
}

TEST(Particles, KnownParticlesHaveTheirColoursAtTheirPixels)
{
    std::vector<Ball> balls;
    for (int i = 0; i < 5; ++i) balls.push_back({in_view(2.5 * i, 0, 0), 1.0, 0.1 + 0.2 * i});
    for (const std::string map : {"inferno", "viridis"}) {
        ParticleView view = test::bare_view(600, 200);
        view.colour_map = map;
        const Image image = render::render_particles(test::polydata(balls), view);
        for (const Ball& ball : balls) {
            const auto [x, y] = pixel_of(balls, view, ball.centre);
            EXPECT_LT(tint_difference(image.pixel(x, y), render::map_colour(map, ball.value)), 5)
                << map << " " << ball.value;
        }
    }
}

TEST(Particles, TheNearerOfTwoParticlesHidesTheOther)
{
    const std::vector<Ball> balls{
        {in_view(0, 0, 3), 1.0, 0.0}, {in_view(0.3, 0, 0), 1.0, 1.0}, {in_view(0, 0, 6), 1.0, 0.0}};
    const ParticleView view = test::bare_view(200, 200);
    const Image image = render::render_particles(test::polydata(balls), view);
    const auto [x, y] = pixel_of(balls, view, balls[1].centre);
    EXPECT_LT(tint_difference(image.pixel(x, y), render::map_colour("inferno", 1)), 5);
}

TEST(Particles, AreLitFromAboveAndNowhereBlack)
{
    const std::vector<Ball> balls{{{0, 0, 0}, 1.0, 1.0}};
    const Image image = render::render_particles(test::polydata(balls), test::bare_view(300, 300));
    const auto brightness = [&](int x, int y) {
        const std::uint8_t* p = image.pixel(x, y);
        return p[0] + p[1] + p[2];
    };
    EXPECT_GT(brightness(150, 70), brightness(150, 230) + 60);
    EXPECT_GT(brightness(150, 230), 100);
}

TEST(Particles, ThePictureIsFilledWhateverTheShapeOfTheBox)
{
    for (const std::array<int, 3> cells : {std::array{4, 4, 4}, {9, 3, 3}, {3, 8, 3}}) {
        ParticleView view = test::bare_view(400, 300);
        view.outline = true;
        for (int d = 0; d < 3; ++d) view.box_length[d] = 2.6 * cells[d];
        const Image image =
            render::render_particles(test::polydata(test::shaken_lattice(cells)), view);
        const render::Rectangle ink = ink_bounds(image);
        EXPECT_GT(std::max(ink.width() / 400, ink.height() / 300), 0.92);
        EXPECT_GT(ink.left, 2);
        EXPECT_GT(ink.top, 2);
        EXPECT_LT(ink.right, 398);
        EXPECT_LT(ink.bottom, 298);
        EXPECT_NEAR((ink.left + ink.right) / 2, 200, 4);
        EXPECT_NEAR((ink.top + ink.bottom) / 2, 150, 4);
    }
}

TEST(Particles, TheBoxIsDrawnWithoutParticles)
{
    ParticleView view = test::bare_view(300, 300);
    view.outline = true;
    view.box_length = {1, 1, 1};
    view.antialiasing = true;
    const Image image = render::render_particles(vtkSmartPointer<vtkPolyData>::New(), view);
    EXPECT_EQ(blob_areas(image).size(), 1u);
    EXPECT_LT(blob_areas(image)[0], 0.1 * 300 * 300);
}

TEST(Particles, VectorsAreColouredByTheirLength)
{
    std::vector<Ball> balls = test::shaken_lattice({2, 2, 2});
    ParticleView view = test::bare_view(160, 160);
    const Image scalar = render::render_particles(test::polydata(balls), view);
    view.colour_by = "velocity";  // (value, 0, 0)
    for (Ball& ball : balls) ball.value = -ball.value;
    const Image vector = render::render_particles(test::polydata(balls), view);
    EXPECT_LE(test::largest_difference(scalar, vector), 1);
}

TEST(Particles, TwoPicturesOfOneSceneAreEqual)
{
    const auto data = test::polydata(test::shaken_lattice({3, 3, 3}));
    ParticleView view;
    view.width = 320;
    view.height = 240;
    view.box_length = {7.8, 7.8, 7.8};
    const Image first = render::render_particles(data, view);
    EXPECT_LE(test::largest_difference(first, render::render_particles(data, view)), 1);
}

TEST(Particles, SmoothedOutlinesHaveManyGreys)
{
    const auto data = test::polydata({{{0, 0, 0}, 1.0, 0.0}});
    ParticleView view = test::bare_view(200, 200);
    const auto greys = [&] {
        const Image image = render::render_particles(data, view);
        int count = 0;
        for (int i = 0; i < 200 * 200; ++i)
            count += image.rgb[3 * i] > 120 && image.rgb[3 * i] < 250;
        return count;
    };
    const int rough = greys();
    view.antialiasing = true;
    EXPECT_GT(greys(), rough + 100);  // the outline is some 550 pixels long
}

TEST(Particles, AmbientOcclusionDarkensGapsButNotFreeSpheres)
{
    // How much darker the pixel in the middle of the first ball becomes.
    const auto darkening = [](const std::vector<Ball>& balls) {
        ParticleView view = test::bare_view(300, 300);
        const auto [x, y] = pixel_of(balls, view, balls[0].centre);
        const auto brightness = [&, x = x, y = y] {
            const Image image = render::render_particles(test::polydata(balls), view);
            return double(image.pixel(x, y)[0]);
        };
        const double without = brightness();
        view.ambient_occlusion = true;
        return brightness() / without;
    };
    const Ball middle{{0, 0, 0}, 1.0, 1.0};
    EXPECT_GT(darkening({middle}), 0.95);
    std::vector<Ball> in_a_hole{middle};
    for (const auto& [right, up] : {std::pair(1.3, 0.0), {-1.3, 0.0}, {0.0, 1.3}, {0.0, -1.3}})
        in_a_hole.push_back({in_view(right, up, -1.5), 1.0, 0.0});
    EXPECT_LT(darkening(in_a_hole), 0.9);
}

TEST(Particles, APlaneHidesTheCentresBeyondItAndChangesNoColour)
{
    std::vector<Ball> balls;
    for (int i = 0; i < 4; ++i) balls.push_back({{3.0 * i, 0, 0}, 1.0, 0.1 + 0.25 * i});
    ParticleView view = test::bare_view(400, 120);
    view.direction = {0, 0};
    const auto shown = [&](const std::optional<render::ClipPlane>& clip) {
        view.clip = clip;
        return render::render_particles(test::polydata(balls), view);
    };
    const Image all = shown(std::nullopt);
    EXPECT_EQ(blob_areas(all).size(), 4u);
    const Image left = shown(render::ClipPlane{0, 6, true});  // a centre in the plane stays
    const Image right = shown(render::ClipPlane{0, 6, false});
    EXPECT_EQ(blob_areas(left).size(), 3u);
    EXPECT_EQ(blob_areas(right).size(), 2u);
    int from_left = 0, from_right = 0;
    for (int x = 0; x < 400; ++x) {  // through the middles: what is left stays as it was
        const std::uint8_t* p = all.pixel(x, 60);
        if (!is_white(left.pixel(x, 60))) from_left += std::equal(p, p + 3, left.pixel(x, 60));
        if (!is_white(right.pixel(x, 60))) from_right += std::equal(p, p + 3, right.pixel(x, 60));
    }
    EXPECT_GT(from_left, 3 * 60);
    EXPECT_GT(from_right, 2 * 60);
}

TEST(Particles, ThePlaneThatHidesAllIsRefused)
{
    ParticleView view = test::bare_view(100, 100);
    view.clip = render::ClipPlane{1, -3, true};
    try {
        render::render_particles(test::polydata({{{0, 2, 0}, 1.0, 0.5}}), view);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_NE(std::string(error.what()).find("y from 2"), std::string::npos) << error.what();
    }
}

TEST(Particles, TheNearerOneIsTheFartherOneFromBehind)
{
    const std::vector<Ball> balls{{{0, 0, 3}, 1.0, 0.9}, {{0, 0, 0}, 1.0, 0.2}};
    ParticleView view = test::bare_view(120, 120);
    const auto middle = [&](double azimuth) {
        view.direction = {azimuth, 0};
        const Image image = render::render_particles(test::polydata(balls), view);
        return std::vector<std::uint8_t>(image.pixel(60, 60), image.pixel(60, 60) + 3);
    };
    EXPECT_LT(tint_difference(middle(0).data(), render::map_colour("inferno", 0.9)), 5);
    EXPECT_LT(tint_difference(middle(180).data(), render::map_colour("inferno", 0.2)), 5);
}

TEST(Particles, LookLikeTheBaseline)
{
    ParticleView view;
    view.width = view.height = 300;
    view.box_length = {10.4, 10.4, 10.4};
    view.title = "$φ$ = 0.56,  $n$ = 64";
    const Image image =
        render::render_particles(test::polydata(test::shaken_lattice({4, 4, 4})), view);
    // Drivers round colours and place shadows a little differently: not the whole 1.
    EXPECT_TRUE(test::matches_baseline(image, "particles", 0.95));
}

TEST(Particles, RefuseWhatCannotBeDrawnAndSayWhatThereIs)
{
    const auto data = test::polydata({{{0, 0, 0}, 1.0, 0.5}});
    const auto message = [&](auto change, std::vector<Ball> balls = {{{0, 0, 0}, 1.0, 0.5}}) {
        ParticleView view = test::bare_view(100, 100);
        change(view);
        try {
            render::render_particles(test::polydata(balls), view);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::input);
            return std::string(error.what());
        }
        return std::string("no error");
    };
    const auto keep = [](ParticleView&) {};
    using testing::PrintToString;
    const auto has = [](const std::string& text, const std::string& part) {
        return text.find(part) != std::string::npos;
    };
    const std::string unknown = message([](ParticleView& v) { v.colour_by = "speed"; });
    EXPECT_TRUE(has(unknown, "\"speed\"") && has(unknown, "nonaffine_speed")) << unknown;
    EXPECT_TRUE(has(message([](ParticleView& v) { v.colour_maximum = -1; }), "colour_maximum"));
    EXPECT_TRUE(has(message([](ParticleView& v) { v.width = 20; }), "20"));
    EXPECT_TRUE(has(message([](ParticleView& v) { v.colour_map = "jet"; }), "jet"));
    EXPECT_TRUE(
        has(message(keep, {{{0, 0, 0}, 1, 0}, {{0, std::nan(""), 0}, 1, 0}}), "particle 1"));
    EXPECT_TRUE(has(message(keep, {{{0, 0, 0}, -2, 0}}), "-2"));
    EXPECT_TRUE(has(message(keep, {}), "no particles"));
}
