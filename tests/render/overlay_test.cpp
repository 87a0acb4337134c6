// tests/render/overlay_test.cpp -- nothing around the particles is cut or lies on something else.
#include "render/particle_overlay.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <numeric>

using namespace sigmaflow::render;

namespace {

Rectangle bounds(const Shape& shape)
{
    Rectangle r{1e9, 1e9, -1e9, -1e9};
    const auto add = [&](const Contour& contour) {
        for (const Point& p : contour)
            r = {std::min(r.left, p.x), std::min(r.top, p.y), std::max(r.right, p.x),
                 std::max(r.bottom, p.y)};
    };
    if (const Fill* fill = std::get_if<Fill>(&shape.form))
        for (const Contour& contour : fill->contours) add(contour);
    else
        add(std::get<Stroke>(shape.form).points);
    return r;
}

bool is_text(const Shape& shape)
{
    const Fill* fill = std::get_if<Fill>(&shape.form);
    return fill && !fill->text.empty();
}

bool overlap(const Rectangle& a, const Rectangle& b)
{
    return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}

const std::vector<std::pair<int, int>> sizes{{1920, 1080}, {300, 300},  {1080, 1080}, {640, 1200},
                                             {3840, 2160}, {960, 1080}, {2400, 700}};

ColourScale long_scale()
{
    return {.map = "inferno",
            .range = {0, 0.0012},
            .values_below = true,
            .values_above = true,
            .label = "a very long label of a colour bar"};
}

}

TEST(Overlay, AllOfItLiesInsideThePicture)
{
    const Fonts fonts;
    for (const auto& [width, height] : sizes) {
        SCOPED_TRACE(testing::Message() << width << " x " << height);
        const ParticleLayout layout = particle_layout(width, height, true, true, true);
        Drawing drawing{width, height, {}};
        draw_triad(drawing, fonts, layout);
        draw_colour_bar(drawing, fonts, long_scale(), layout);
        draw_title(drawing, fonts,
                   "a title that is much longer than any picture is wide, $φ$ = 0.56, "
                   "$σ$/$σ$_{0} = 2, $n$ = 4500, $γ$ = 12.5, and more than that",
                   layout);
        for (const Shape& shape : drawing.shapes) {
            const Rectangle r = bounds(shape);
            EXPECT_GE(r.left, 1);
            EXPECT_GE(r.top, 1);
            EXPECT_LE(r.right, width - 1);
            EXPECT_LE(r.bottom, height - 1);
        }
    }
}

TEST(Overlay, TriadAndBarKeepOffTheParticles)
{
    const Fonts fonts;
    for (const auto& [width, height] : sizes) {
        SCOPED_TRACE(testing::Message() << width << " x " << height);
        const ParticleLayout layout = particle_layout(width, height, true, true, true);
        Drawing drawing{width, height, {}};
        draw_triad(drawing, fonts, layout);
        draw_colour_bar(drawing, fonts, long_scale(), layout);
        draw_title(drawing, fonts, "$φ$ = 0.56", layout);
        for (const Shape& shape : drawing.shapes)
            EXPECT_FALSE(overlap(bounds(shape), layout.particles));
        EXPECT_GT(layout.particles.width() * layout.particles.height(), 0.2 * width * height);
    }
}

TEST(Overlay, TriadsOfAllViewsLieInThePictureAndOffTheParticles)
{
    const Fonts fonts;
    const ViewDirection views[] = {{0, 0},    {0, 90},  {0, -90},   {90, 0},
                                   {-90, 0},  {180, 0}, {45, 35.3}, {135, -35},
                                   {-60, 20}, {22, 15}, {200, -40}, {250, 60}};
    for (const auto& [width, height] : sizes)
        for (const ViewDirection& view : views) {
            SCOPED_TRACE(testing::Message() << width << " x " << height << ", azimuth "
                                            << view.azimuth << ", elevation " << view.elevation);
            const ParticleLayout layout = particle_layout(width, height, true, true, true);
            Drawing drawing{width, height, {}};
            draw_triad(drawing, fonts, layout, view_axes(view));
            int texts = 0;
            for (const Shape& shape : drawing.shapes) {
                const Rectangle r = bounds(shape);
                EXPECT_GE(r.left, 0);
                EXPECT_LE(r.bottom, height);
                EXPECT_FALSE(overlap(r, layout.particles));
                if (!is_text(shape)) continue;
                ++texts;
                for (const Shape& other : drawing.shapes)
                    EXPECT_FALSE(&other != &shape && is_text(other) && overlap(r, bounds(other)));
            }
            EXPECT_EQ(texts, 3);
        }
}

TEST(Overlay, TheSmallestPicturesStillHaveRoomForParticles)
{
    for (const auto& [width, height] : {std::pair(64, 64), {100, 100}, {64, 16384}, {16384, 64}}) {
        const ParticleLayout layout = particle_layout(width, height, true, true, true);
        EXPECT_GT(layout.particles.width(), 15) << width << " x " << height;
        EXPECT_GT(layout.particles.height(), 15) << width << " x " << height;
        EXPECT_GT(layout.colour_bar.height(), 15) << width << " x " << height;
    }
}

TEST(Overlay, TriadLabelsKeepOffTheArrowsAndOffEachOther)
{
    const Fonts fonts;
    for (const auto& [width, height] : sizes) {
        SCOPED_TRACE(testing::Message() << width << " x " << height);
        Drawing drawing{width, height, {}};
        draw_triad(drawing, fonts, particle_layout(width, height, true, true, true));
        int texts = 0;
        for (std::size_t i = 0; i < drawing.shapes.size(); ++i) {
            if (!is_text(drawing.shapes[i])) continue;
            ++texts;
            for (std::size_t j = 0; j < drawing.shapes.size(); ++j)
                EXPECT_FALSE(j != i &&
                             overlap(bounds(drawing.shapes[i]), bounds(drawing.shapes[j])));
        }
        EXPECT_EQ(texts, 3);
    }
}

TEST(Overlay, ColourRangesEndAtRoundNumbers)
{
    std::vector<double> values(1001);
    std::iota(values.begin(), values.end(), 0.0);
    for (double& value : values) value /= 1000;  // 99 % quantile 0.99
    const Range unit = colour_range(values, false);
    EXPECT_DOUBLE_EQ(unit.from, 0);
    EXPECT_DOUBLE_EQ(unit.to, 1);
    for (double& value : values) value -= 0.5;
    const Range signed_range = colour_range(values, false);
    EXPECT_NEAR(signed_range.from, -0.6, 1e-12);
    EXPECT_NEAR(signed_range.to, 0.6, 1e-12);
    EXPECT_DOUBLE_EQ(colour_range({0, 3, 5, 9}, true).to, 10);
    EXPECT_DOUBLE_EQ(colour_range({1, 1, 1.4}, false).to, 1.4);
    EXPECT_DOUBLE_EQ(colour_range({0, 0, 0}, false).to, 1);
    EXPECT_DOUBLE_EQ(colour_range({}, false).to, 1);
}

TEST(Overlay, EndsOfAnAutomaticColourBarAreLabelled)
{
    for (double largest = 0.013; largest < 3000; largest *= 1.17) {
        const Range range = colour_range({0, largest}, false);
        const std::vector<Tick> ticks = linear_ticks(range, 7);
        EXPECT_FALSE(ticks.front().label.empty()) << largest;
        EXPECT_FALSE(ticks.back().label.empty()) << largest;
        EXPECT_NEAR(ticks.back().value, range.to, 1e-9 * range.to);
        EXPECT_GE(range.to, largest * (1 - 1e-6));
    }
}

TEST(Overlay, ClippedValuesAreMarkedOnTheBar)
{
    const Fonts fonts;
    const auto texts = [&](bool above) {
        ColourScale scale{.map = "viridis", .range = {0, 1}, .values_above = above, .label = "x"};
        Drawing drawing{800, 600, {}};
        draw_colour_bar(drawing, fonts, scale, particle_layout(800, 600, false, true, false));
        std::vector<std::string> found;
        for (const Shape& shape : drawing.shapes)
            if (is_text(shape)) found.push_back(std::get<Fill>(shape.form).text);
        return found;
    };
    const auto has = [](const std::vector<std::string>& all, const std::string& text) {
        return std::count(all.begin(), all.end(), text) == 1;
    };
    EXPECT_TRUE(has(texts(true), "≥ 1.0"));
    EXPECT_FALSE(has(texts(true), "1.0"));
    EXPECT_TRUE(has(texts(false), "1.0"));
}

TEST(Overlay, LabelsOfTheParticleArrays)
{
    EXPECT_EQ(array_label("nonaffine_speed"), "|$U$ − $U$^{∞}| / ($γ\u0307$ $a$)");
    EXPECT_EQ(array_label("contact_number"), "contacts per particle");
    EXPECT_EQ(array_label("local_density"), "local density");  // an array nobody has heard of
}
