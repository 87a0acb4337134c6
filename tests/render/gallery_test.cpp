// tests/render/gallery_test.cpp -- every kind of picture that the program draws, against a baseline
// that people have looked at (tests/images).
#include "render/line_plot.h"
#include "render/panels.h"
#include "render/particles.h"
#include "render/polar_map.h"
#include "tests/render/scenes.h"
#include "tests/support/image_compare.h"

#include <gtest/gtest.h>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <set>

using namespace sigmaflow;
using render::Image;
using render::ParticleView;

namespace {

ParticleView small_view()
{
    ParticleView view;
    view.width = 240;
    view.height = 200;
    view.box_length = {10.4, 7.8, 7.8};
    return view;
}

Image particles(const std::function<void(ParticleView&)>& change)
{
    ParticleView view = small_view();
    std::vector<test::Ball> balls = test::shaken_lattice({4, 3, 3});
    change(view);
    if (view.colour_by == "contact_number")
        for (test::Ball& ball : balls) ball.value *= 6;
    return render::render_particles(test::polydata(balls), view);
}

Image chains()
{
    ParticleView view = small_view();
    view.colour_by = "normal_force";
    const std::vector<test::Ball> balls = test::shaken_lattice({4, 3, 3});
    std::vector<test::Rod> contacts;
    for (std::size_t i = 0; i < balls.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            double square = 0;
            for (std::size_t d = 0; d < 3; ++d)
                square += std::pow(balls[i].centre[d] - balls[j].centre[d], 2);
            if (square < 2.5 * 2.5)
                contacts.push_back({balls[i].centre, balls[j].centre,
                                    1 + std::sin(1.3 * static_cast<double>(i + 7 * j))});
        }
    return render::render_chains(test::polydata(balls), test::contacts(contacts), view);
}

render::Plot small_plot()
{
    render::Plot plot;
    plot.width = 240;
    plot.height = 200;
    return plot;
}

/// A velocity profile: errors in both directions around a straight line.
Image profile()
{
    render::Plot plot = small_plot();
    plot.x.title = "$U_{x}$/($γ̇$ $L$)";
    plot.y.title = "$y$/$L$";
    render::Series mean, linear;
    mean.label = "mean";
    mean.line = render::Line::none;
    mean.marker = render::Marker::circle;
    linear.label = "linear";
    linear.line = render::Line::dashed;
    for (int k = 0; k < 10; ++k) {
        const double y = (k + 0.5) / 10;
        mean.x.push_back(y - 0.5 + 0.03 * std::sin(5. * k));
        mean.y.push_back(y);
        mean.x_error.push_back(0.05);
        mean.y_error.push_back(0.05);
        linear.x.push_back(y - 0.5);
        linear.y.push_back(y);
    }
    plot.series = {mean, linear};
    return render::render_plot(plot);
}

/// A distribution on a logarithmic axis, with errors, an empty bin and a law.
Image histogram()
{
    render::Plot plot = small_plot();
    plot.x.title = "$F$/⟨$F$⟩";
    plot.y.title = "density";
    plot.y.logarithmic = true;
    render::Series density, law;
    density.line = render::Line::none;
    density.marker = render::Marker::square;
    density.open_marker = true;
    density.label = "normal";
    law.label = "exp";
    law.line = render::Line::dotted;
    for (int k = 0; k < 12; ++k) {
        const double x = 0.5 * k + 0.25, y = std::exp(-x);
        law.x.push_back(x);
        law.y.push_back(y);
        density.x.push_back(x);
        density.y.push_back(k == 9 ? std::numeric_limits<double>::quiet_NaN()
                                   : y * (1 + 0.2 * std::sin(3. * k)));
        density.y_error.push_back(0.3 * y);
    }
    plot.series = {density, law};
    return render::render_plot(plot);
}

/// Field of strain and gradient: cells, one of them unknown, with their bar and a line above.
Image heat_map(const std::string& map)
{
    render::Plot plot = small_plot();
    plot.x.title = "strain $γ$";
    plot.y.title = "$y$/$L$";
    render::ColourGrid grid;
    grid.map = map;
    grid.label = "$γ̇$/⟨$γ̇$⟩";
    grid.maximum = 2;
    for (int k = 0; k <= 12; ++k) grid.x.push_back(0.5 * k);
    for (int k = 0; k <= 8; ++k) grid.y.push_back(k / 8.);
    for (int row = 0; row < 8; ++row)
        for (int column = 0; column < 12; ++column)
            grid.values.push_back(1 + std::sin(0.7 * column + row));
    grid.values[30] = std::numeric_limits<double>::quiet_NaN();
    plot.grid = grid;
    render::Series line;
    line.x = {0, 6};
    line.y = {0.2, 0.8};
    plot.series = {line};
    return render::render_plot(plot);
}

Image polar_map()
{
    render::PolarMap map;
    map.height = 200;
    map.title = "$g$($r$, $θ$)";
    map.x_title = "$x$";
    map.y_title = "$y$";
    map.label = "$g$";
    map.largest_distance = 4;
    map.rings = 16;
    map.sectors = 24;
    for (int ring = 0; ring < map.rings; ++ring)
        for (int sector = 0; sector < map.sectors; ++sector)
            map.values.push_back(
                ring < 6 ? 0 : 1 + std::exp(6. - ring) * (1 - std::sin(2 * M_PI * sector / 24)));
    return render::render_polar_map(map);
}

Image all_panels()
{
    return render::panels({{profile(), ""},
                           {histogram(), ""},
                           {heat_map("viridis"), ""},
                           {Image(), "jammed: no profile"}},
                          {.columns = 2, .width = 420, .letters = true});
}

struct Kind {
    std::string name;
    std::function<Image()> draw;
    double least_similarity;  // less where a driver draws
};

void PrintTo(const Kind& kind, std::ostream* out)
{
    *out << kind.name;
}

// Drivers round colours and place shadows a little differently.
constexpr double drawn_by_a_driver = 0.95, drawn_by_us = 0.98;

std::vector<Kind> kinds()
{
    const auto of_particles = [](const char* name, void (*change)(ParticleView&)) {
        return Kind{name, [change] { return particles(change); }, drawn_by_a_driver};
    };
    return {
        of_particles("particles_speed", [](ParticleView&) {}),
        of_particles("particles_contact_number",
                     [](ParticleView& v) { v.colour_by = "contact_number"; }),
        of_particles("particles_radius",
                     [](ParticleView& v) {
                         v.colour_by = "radius";
                         v.colour_map = "viridis";
                     }),
        of_particles("particles_velocity",
                     [](ParticleView& v) {
                         v.colour_by = "velocity";
                         v.colour_map = "paper";
                         v.title = "$ϕ$ = 0.56";
                     }),
        of_particles("particles_clipped",
                     [](ParticleView& v) {
                         v.clip = render::ClipPlane{2, 4.5, true};
                     }),
        of_particles("particles_front",
                     [](ParticleView& v) {
                         v.direction = {0, 0};
                     }),
        of_particles("particles_top",
                     [](ParticleView& v) {
                         v.direction = {0, 90};
                     }),
        of_particles("particles_zoomed",
                     [](ParticleView& v) {
                         v.direction = {-130, -30};
                         v.zoom = 2.5;
                     }),
        {"chains", chains, drawn_by_a_driver},
        {"profile", profile, drawn_by_us},
        {"histogram", histogram, drawn_by_us},
        {"heat_map", [] { return heat_map("viridis"); }, drawn_by_us},
        {"heat_map_blue_red", [] { return heat_map("blue_red"); }, drawn_by_us},
        {"polar_map", polar_map, drawn_by_us},
        {"panels", all_panels, drawn_by_us},
    };
}

class Gallery : public testing::TestWithParam<Kind> {};

}

TEST_P(Gallery, LooksAsItDid)
{
    const Kind& kind = GetParam();
    EXPECT_TRUE(test::matches_baseline(kind.draw(), kind.name, kind.least_similarity));
}

INSTANTIATE_TEST_SUITE_P(All, Gallery, testing::ValuesIn(kinds()),
                         [](const auto& kind) { return kind.param.name; });

TEST(GalleryOfImages, HasNoBaselineThatNothingIsComparedWith)
{
    std::set<std::string> known{"particles", "plot_linear", "plot_log"};  // of other tests
    for (const Kind& kind : kinds()) known.insert(kind.name);
    for (const auto& entry : std::filesystem::directory_iterator(SIGMAFLOW_TEST_IMAGES))
        if (entry.path().extension() == ".png") {
            EXPECT_TRUE(known.contains(entry.path().stem().string())) << entry.path();
        }
}
