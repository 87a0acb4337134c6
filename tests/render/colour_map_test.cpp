// tests/render/colour_map_test.cpp
#include "render/colour_map.h"
#include "engine/error.h"

#include <gtest/gtest.h>
#include <cmath>

using namespace sigmaflow;
using render::Colour;
using render::map_colour;

namespace {

/// CIE lightness L* of an sRGB colour.
double lightness(const Colour& colour)
{
    const double weights[3] = {0.2126, 0.7152, 0.0722};
    double luminance = 0;
    for (int c = 0; c < 3; ++c) {
        const double v = colour[c] / 255.0;
        luminance += weights[c] * (v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
    }
    return luminance > 0.008856 ? 116 * std::cbrt(luminance) - 16 : 903.3 * luminance;
}

}

TEST(ColourMap, AgreesWithThePublishedTables)  // oracle: matplotlib's listed colours
{
    EXPECT_EQ(map_colour("viridis", 0.0), (Colour{68, 1, 84}));
    EXPECT_EQ(map_colour("viridis", 0.5), (Colour{33, 144, 140}));
    EXPECT_EQ(map_colour("viridis", 1.0), (Colour{253, 231, 37}));
    EXPECT_EQ(map_colour("inferno", 1.0), (Colour{252, 255, 164}));
    // Entries 85 and 170 of 255 of viridis lie between our knots: #31688e and #35b779.
    const Colour third = map_colour("viridis", 85 / 255.0);
    const Colour two_thirds = map_colour("viridis", 170 / 255.0);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(third[c], (Colour{0x31, 0x68, 0x8e})[c], 3);
        EXPECT_NEAR(two_thirds[c], (Colour{0x35, 0xb7, 0x79})[c], 4);
    }
}

TEST(ColourMap, GetsLighterFromEndToEnd)  // what makes an order readable, also in grey
{
    for (const std::string map : {"inferno", "viridis", "paper"}) {
        double before = -1;
        for (int i = 0; i <= 40; ++i) {
            const double here = lightness(map_colour(map, i / 40.0));
            EXPECT_GT(here, before) << map << " at " << i / 40.0;
            before = here;
        }
    }
}

TEST(ColourMap, OfTwoSidesIsLightestInTheMiddleAndAsDarkOnBothSides)
{
    for (int i = 0; i < 20; ++i) {
        const double here = lightness(map_colour("blue_red", i / 40.0));
        EXPECT_LT(here, lightness(map_colour("blue_red", (i + 1) / 40.0))) << i;
        EXPECT_NEAR(here, lightness(map_colour("blue_red", 1 - i / 40.0)), 6) << i;
    }
    const Colour low = map_colour("blue_red", 0), high = map_colour("blue_red", 1);
    EXPECT_GT(low[2], low[0]);
    EXPECT_GT(high[0], high[2]);
}

TEST(ColourMap, BeginsBrightEnoughForShading)
{
    EXPECT_GT(lightness(map_colour("inferno", 0)), 8);
    EXPECT_GT(lightness(map_colour("paper", 0)), 8);
}

TEST(ColourMap, PaperGoesFromGreyToYellow)
{
    const Colour dark = map_colour("paper", 0), light = map_colour("paper", 1);
    EXPECT_LE(std::abs(dark[0] - dark[1]) + std::abs(dark[1] - dark[2]), 6);
    EXPECT_GT(light[0], 240);
    EXPECT_GT(light[1], 220);
    EXPECT_LT(light[2], 60);
}

TEST(ColourMap, HoldsItsEndsAndShowsMissingValuesGrey)
{
    EXPECT_EQ(map_colour("viridis", -3), map_colour("viridis", 0));
    EXPECT_EQ(map_colour("viridis", 7), map_colour("viridis", 1));
    const Colour missing = map_colour("viridis", std::nan(""));
    EXPECT_EQ(missing[0], missing[1]);
    EXPECT_EQ(missing[1], missing[2]);
}

TEST(ColourMap, RefusesAnUnknownNameAndListsTheKnownOnes)
{
    try {
        map_colour("jet", 0.5);
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_NE(std::string(error.what()).find("viridis"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("jet"), std::string::npos);
    }
}
