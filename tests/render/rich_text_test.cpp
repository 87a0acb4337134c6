// tests/render/rich_text_test.cpp
#include "render/rich_text.h"

#include <gtest/gtest.h>

using namespace sigmaflow::render;

TEST(RichText, IsCutIntoRuns)
{
    const std::vector<TextRun> expected{{"rate ", Face::upright, Script::normal},
                                        {"γ", Face::italic, Script::normal},
                                        {"0", Face::upright, Script::below},
                                        {" = 10", Face::upright, Script::normal},
                                        {"−3", Face::upright, Script::above}};
    EXPECT_EQ(parse_rich_text("rate $γ$_{0} = 10^{−3}"), expected);
}

TEST(RichText, ItalicMaySwitchInsideAScript)
{
    const std::vector<TextRun> expected{{"u", Face::italic, Script::normal},
                                        {"x", Face::italic, Script::below},
                                        {",max", Face::upright, Script::below}};
    EXPECT_EQ(parse_rich_text("$u$_{$x$,max}"), expected);
}

TEST(RichText, SignsWithoutBracesAreOrdinary)
{
    const std::vector<TextRun> expected{{"a_b^c {d}", Face::upright, Script::normal}};
    EXPECT_EQ(parse_rich_text("a_b^c {d}"), expected);
    EXPECT_TRUE(parse_rich_text("").empty());
    EXPECT_TRUE(parse_rich_text("$$").empty());
}

TEST(RichText, UnclosedMarksHoldToTheEnd)
{
    const std::vector<TextRun> expected{{"a", Face::upright, Script::normal},
                                        {"b", Face::upright, Script::below}};
    EXPECT_EQ(parse_rich_text("a_{b"), expected);
    EXPECT_EQ(plain_text("$x_{1"), "x1");
}

TEST(RichText, ScriptsAreSmallerAndMarkUpTakesNoRoom)
{
    const Fonts fonts;
    EXPECT_LT(text_width(fonts, "a_{mm}"), text_width(fonts, "amm"));
    EXPECT_NEAR(text_width(fonts, "a_{b}c"), text_width(fonts, "ac") + 0.7 * text_width(fonts, "b"),
                0.02);
    EXPECT_EQ(text_width(fonts, ""), 0);
}

TEST(RichText, IsPlacedByItsEndOrMiddle)
{
    const Fonts fonts;
    const auto middle = [&](Align align, bool upwards) {
        Drawing drawing{400, 400, {}};
        draw_text(drawing, fonts, "HHHH", {200, 200},
                  {.size = 40, .align = align, .upwards = upwards});
        double low = 1e9, high = -1e9;
        for (const Contour& contour : std::get<Fill>(drawing.shapes.at(0).form).contours) {
            for (const Point& p : contour) {
                low = std::min(low, upwards ? p.y : p.x);
                high = std::max(high, upwards ? p.y : p.x);
            }
        }
        return (low + high) / 2;
    };
    const double half = 20 * text_width(fonts, "HHHH");
    EXPECT_NEAR(middle(Align::centre, false), 200, 0.5);
    EXPECT_NEAR(middle(Align::left, false), 200 + half, 0.5);
    EXPECT_NEAR(middle(Align::right, false), 200 - half, 0.5);
    EXPECT_NEAR(middle(Align::centre, true), 200, 0.5);
    EXPECT_NEAR(middle(Align::left, true), 200 - half, 0.5);
}
