// tests/render/drawing_test.cpp -- areas and lengths against closed forms.
#include "render/drawing.h"

#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

using namespace sigmaflow::render;

namespace {

/// Ink on a white picture, in fully black pixels.
double ink_area(const Drawing& drawing)
{
    Image image(drawing.width, drawing.height);
    rasterise(drawing, image);
    double sum = 0;
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) sum += 255 - image.rgb[i];
    return sum / 255;
}

Drawing of(Fill fill)
{
    Drawing drawing{100, 100, {}};
    drawing.fill(std::move(fill));
    return drawing;
}

Drawing of(Stroke stroke)
{
    Drawing drawing{100, 100, {}};
    drawing.stroke(std::move(stroke));
    return drawing;
}

double length(const std::vector<Contour>& pieces)
{
    double sum = 0;
    for (const Contour& piece : pieces)
        for (std::size_t i = 0; i + 1 < piece.size(); ++i)
            sum += std::hypot(piece[i + 1].x - piece[i].x, piece[i + 1].y - piece[i].y);
    return sum;
}

}

TEST(Drawing, FillsTheAreaOfPolygons)
{
    EXPECT_NEAR(ink_area(of(Fill{{{{10.3, 20.6}, {70.1, 30.2}, {25.7, 88.4}}}, {}, {}})),
                0.5 * std::abs((70.1 - 10.3) * (88.4 - 20.6) - (25.7 - 10.3) * (30.2 - 20.6)), 3);
    EXPECT_NEAR(ink_area(of(Fill{{circle_contour({50, 50}, 30)}, {}, {}})), std::numbers::pi * 900,
                15);
}

TEST(Drawing, CoversPartsOfPixelsExactlyAcross)
{
    Drawing drawing = of(Fill{{rectangle_contour({10.25, 10, 20.5, 11})}, {}, {}});
    Image image(100, 100);
    rasterise(drawing, image);
    EXPECT_NEAR(255 - image.pixel(10, 10)[0], 0.75 * 255, 1);
    EXPECT_EQ(image.pixel(15, 10)[0], 0);
    EXPECT_NEAR(255 - image.pixel(20, 10)[0], 0.5 * 255, 1);
    EXPECT_EQ(image.pixel(21, 10)[0], 255);
    EXPECT_EQ(image.pixel(15, 11)[0], 255);
}

TEST(Drawing, LeavesHolesThatRunTheOtherWayRound)
{
    Contour hole = rectangle_contour({30, 30, 60, 60});
    const Contour outer = rectangle_contour({10, 10, 90, 90});
    EXPECT_NEAR(ink_area(of(Fill{{outer, hole}, {}, {}})), 6400, 1);
    std::reverse(hole.begin(), hole.end());
    EXPECT_NEAR(ink_area(of(Fill{{outer, hole}, {}, {}})), 6400 - 900, 1);
}

TEST(Drawing, LinesHaveTheirWidthAndCountJointsOnce)
{
    // Two sides at a right angle: the round joint adds a quarter disc.
    const Stroke angle{
        .points = {{20, 20}, {80, 20}, {80, 70}}, .ink = {}, .width = 6, .dashes = {}};
    EXPECT_NEAR(ink_area(of(angle)), 110 * 6 - 9 + std::numbers::pi * 9 / 4, 2);
    // Going back on itself covers nothing new.
    const Stroke back{
        .points = {{20, 20}, {80, 20}, {20, 20}}, .ink = {}, .width = 6, .dashes = {}};
    EXPECT_NEAR(ink_area(of(back)), 60 * 6 + std::numbers::pi * 9 / 2, 2);
}

TEST(Drawing, RoundEndsAddTwoHalfDiscs)
{
    const Stroke line{
        .points = {{20, 20}, {80, 60}}, .ink = {}, .width = 8, .dashes = {}, .round = true};
    EXPECT_NEAR(ink_area(of(line)), std::hypot(60, 40) * 8 + std::numbers::pi * 16, 3);
}

TEST(Drawing, AThousandPointsOnALineDrawTheSameLine)
{
    Stroke dense{.points = {}, .ink = {}, .width = 2, .dashes = {}};
    for (int i = 0; i <= 1000; ++i) dense.points.push_back({10 + 0.08 * i, 20 + 0.06 * i});
    const Stroke sparse{.points = {{10, 20}, {90, 80}}, .ink = {}, .width = 2, .dashes = {}};
    EXPECT_NEAR(ink_area(of(dense)), ink_area(of(sparse)), 0.5);
}

TEST(Drawing, DashesKeepTheirLengthsAroundCorners)
{
    const Contour path{{0, 0}, {10, 0}, {10, 11}};
    const std::vector<Contour> pieces = dash_pieces(path, {4, 3});  // on 0-4, 7-11, 14-18 of 21
    ASSERT_EQ(pieces.size(), 3u);
    EXPECT_NEAR(length(pieces), 12, 1e-12);
    EXPECT_EQ(pieces[1].size(), 3u);  // goes through the corner
    EXPECT_NEAR(pieces[2][0].y, 4, 1e-12);
}

TEST(Drawing, ClipsToARectangle)
{
    Drawing drawing{100, 100, {}};
    drawing.fill({{circle_contour({50, 50}, 40)}, {}, {}}, Rectangle{45, 48, 55, 52});
    EXPECT_NEAR(ink_area(drawing), 40, 0.5);
}

TEST(Drawing, IgnoresWhatLiesOutsideThePicture)
{
    EXPECT_EQ(ink_area(of(Fill{{rectangle_contour({-500, -500, -1, 1e6})}, {}, {}})), 0);
    EXPECT_NEAR(ink_area(of(Fill{{rectangle_contour({-1e5, -1e5, 1e5, 1e5})}, {}, {}})), 1e4, 1);
}

TEST(Drawing, TransparentInkMixesWithWhatIsBelow)
{
    Drawing drawing{100, 100, {}};
    drawing.fill({{rectangle_contour({0, 0, 100, 100})}, {{100, 100, 100}}, {}});
    drawing.fill({{rectangle_contour({0, 0, 50, 100})}, {{200, 0, 100}, 0.25}, {}});
    Image image(100, 100);
    rasterise(drawing, image);
    EXPECT_EQ(image.pixel(10, 10)[0], 125);
    EXPECT_EQ(image.pixel(10, 10)[1], 75);
    EXPECT_EQ(image.pixel(10, 10)[2], 100);
    EXPECT_EQ(image.pixel(60, 10)[0], 100);
}
