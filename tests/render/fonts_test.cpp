// tests/render/fonts_test.cpp
#include "render/fonts.h"
#include "engine/error.h"

#include <gtest/gtest.h>
#include <algorithm>

using namespace sigmaflow;
using namespace sigmaflow::render;

namespace {

Rectangle bounds(const TextOutline& outline)
{
    Rectangle r{1e9, 1e9, -1e9, -1e9};
    for (const Contour& contour : outline.contours)
        for (const Point& p : contour)
            r = {std::min(r.left, p.x), std::min(r.top, p.y), std::max(r.right, p.x),
                 std::max(r.bottom, p.y)};
    return r;
}

}

TEST(Fonts, HaveEverySignTheLabelsNeed)
{
    const Fonts fonts;
    const Rectangle missing = bounds(fonts.outline("\uE123", Face::upright));  // not in any font
    for (const std::string sign : {"φ", "σ", "γ", "η", "Ω", "μ", "−", "×", "±", "∞", "≥", "≤", "⟨",
                                   "⟩", "·", "ξ", "∝", "→", "Δ"}) {
        for (const Face face : {Face::upright, Face::italic}) {
            const Rectangle r = bounds(fonts.outline(sign, face));
            EXPECT_GT(r.width(), 0) << sign;
            EXPECT_FALSE(r.left == missing.left && r.right == missing.right && r.top == missing.top)
                << sign << " is drawn as a missing letter";
        }
    }
}

TEST(Fonts, StandOnTheBaseLineWithTheirKnownHeight)
{
    const Fonts fonts;
    const Rectangle r = bounds(fonts.outline("H", Face::upright));
    EXPECT_NEAR(r.bottom, 0, 1e-3);
    EXPECT_NEAR(r.top, -0.729, 2e-3);  // capital height of DejaVu Sans: 1493 / 2048
}

TEST(Fonts, DotStandsAboveTheMiddleOfItsLetterAndTakesNoWidth)
{
    const Fonts fonts;
    const TextOutline plain = fonts.outline("γ", Face::italic);
    const TextOutline dotted = fonts.outline("γ\u0307", Face::italic);
    EXPECT_DOUBLE_EQ(dotted.advance, plain.advance);
    ASSERT_EQ(dotted.contours.size(), plain.contours.size() + 1);
    const Rectangle letter = bounds(plain), dot = bounds({{dotted.contours.back()}, 0});
    EXPECT_LT(dot.bottom, letter.top);
    EXPECT_GT(dot.bottom, letter.top - 0.15);
    EXPECT_NEAR((dot.left + dot.right) / 2, (letter.left + letter.right) / 2, 0.06);
}

TEST(Fonts, PairsOfLettersAreKerned)
{
    const Fonts fonts;
    const double alone =
        fonts.outline("A", Face::upright).advance + fonts.outline("V", Face::upright).advance;
    EXPECT_LT(fonts.outline("AV", Face::upright).advance, alone - 0.01);
    EXPECT_NEAR(fonts.outline("HH", Face::upright).advance,
                2 * fonts.outline("H", Face::upright).advance, 1e-12);
}

TEST(Fonts, MissingFilesNameThePackage)
{
    try {
        const Fonts fonts({"/nonexistent"});
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::rendering);
        EXPECT_NE(std::string(error.what()).find("fonts-dejavu-core"), std::string::npos);
    }
}

TEST(Fonts, Utf8IsDecodedAndWrongBytesAreMarked)
{
    EXPECT_EQ(decode_utf8("aγ∞\U0001F600"), U"aγ∞\U0001F600");
    EXPECT_EQ(decode_utf8("a\xffz"), U"a\uFFFDz");
    EXPECT_EQ(decode_utf8("\xe2\x88"), U"\uFFFD");  // cut in the middle of a letter
    EXPECT_EQ(decode_utf8("\xce|"), U"\uFFFD|");
}
