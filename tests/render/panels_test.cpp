// tests/render/panels_test.cpp
#include "render/panels.h"

#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

using namespace sigmaflow::render;

namespace {

/// Grey waves along x with this wavelength [pixels], around 128.
Image waves(int width, int height, double wavelength, double amplitude = 100)
{
    Image image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int channel = 0; channel < 3; ++channel)
                image.pixel(x, y)[channel] = static_cast<std::uint8_t>(std::lround(
                    128 + amplitude * std::cos(2 * std::numbers::pi * (x + 0.5) / wavelength)));
    return image;
}

/// Half of the largest difference in the middle half of a row.
double amplitude(const Image& image)
{
    int low = 255, high = 0;
    for (int x = image.width / 4; x < 3 * image.width / 4; ++x) {
        const int value = image.pixel(x, image.height / 2)[0];
        low = std::min(low, value);
        high = std::max(high, value);
    }
    return (high - low) / 2.0;
}

Image turned(const Image& image)
{
    Image result(image.height, image.width);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) std::copy_n(image.pixel(x, y), 3, result.pixel(y, x));
    return result;
}

bool is_colour(const Image& image, int column, int row, const Colour& colour)
{
    const std::uint8_t* p = image.pixel(column, row);
    return p[0] == colour[0] && p[1] == colour[1] && p[2] == colour[2];
}

int dark_pixels(const Image& image, int left, int top, int right, int bottom)
{
    int count = 0;
    for (int y = top; y < bottom; ++y)
        for (int x = left; x < right; ++x) count += image.pixel(x, y)[0] < 100;
    return count;
}

constexpr Colour red{200, 10, 10}, green{10, 200, 10}, blue{10, 10, 200}, white{255, 255, 255};

}

TEST(Resized, SameSizeIsTheSamePicture)
{
    const Image image = waves(40, 7, 9);
    EXPECT_EQ(resized(image, 40, 7).rgb, image.rgb);
}

TEST(Resized, FlatColoursStayExactlyWhatTheyAre)
{
    for (const auto& [width, height] :
         {std::pair{1, 1}, {13, 200}, {200, 13}, {50, 30}, {51, 29}}) {
        const Image result = resized(Image(50, 30, {17, 130, 255}), width, height);
        ASSERT_EQ(result.width, width);
        ASSERT_EQ(result.height, height);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) ASSERT_TRUE(is_colour(result, x, y, {17, 130, 255}));
    }
}

TEST(Resized, ARampStaysTheSameRamp)
{
    Image ramp(200, 1);
    for (int x = 0; x < 200; ++x) ramp.pixel(x, 0)[0] = static_cast<std::uint8_t>(x + 20);
    for (int width : {50, 80, 333, 600}) {
        const Image result = resized(ramp, width, 1);
        for (int x = width / 10; x < width - width / 10; ++x)
            ASSERT_NEAR(result.pixel(x, 0)[0], 20 + (x + 0.5) * 200 / width - 0.5, 1.1) << width;
    }
}

TEST(Resized, SmoothWavesKeepTheirHeightAndFinerThanPixelsBecomeTheirMean)
{
    EXPECT_NEAR(amplitude(resized(waves(600, 4, 30), 300, 4)), 100, 2);
    EXPECT_NEAR(amplitude(resized(waves(600, 4, 30), 900, 4)), 100, 2);
    // a third of the pixels: waves of four pixels are beyond what they can show
    const Image fine = resized(waves(600, 4, 4), 200, 4);
    EXPECT_LT(amplitude(fine), 12);
    EXPECT_NEAR(fine.pixel(100, 2)[0], 128, 12);
    EXPECT_LT(amplitude(resized(waves(600, 4, 2.3), 100, 4)), 2);
}

TEST(Resized, TreatsRowsAsColumns)
{
    const Image image = waves(60, 24, 11);
    EXPECT_EQ(resized(turned(image), 10, 37).rgb, turned(resized(image, 37, 10)).rgb);
}

TEST(Panels, StandRowByRowInEquallyWideColumns)
{
    const Image whole = panels({{Image(40, 30, red), ""},
                                {Image(400, 300, green), ""},
                                {Image(200, 100, blue), ""},
                                {Image(50, 200, red), ""}},
                               {.columns = 2, .width = 400, .letters = false});
    // columns of 198 pixels and a gap of 4; the rows are 149 (198 * 3/4) and 198 high
    ASSERT_EQ(whole.width, 400);
    ASSERT_EQ(whole.height, 149 + 4 + 198);
    EXPECT_TRUE(is_colour(whole, 0, 0, red));
    EXPECT_TRUE(is_colour(whole, 197, 148, red));
    EXPECT_TRUE(is_colour(whole, 200, 74, white));
    EXPECT_TRUE(is_colour(whole, 202, 0, green));
    EXPECT_TRUE(is_colour(whole, 399, 148, green));
    EXPECT_TRUE(is_colour(whole, 100, 150, white));
    // 198 x 99, in the middle of its row
    EXPECT_TRUE(is_colour(whole, 100, 153 + 48, white));
    EXPECT_TRUE(is_colour(whole, 0, 153 + 50, blue));
    EXPECT_TRUE(is_colour(whole, 197, 153 + 147, blue));
    // a tall one is as high as its column is wide
    EXPECT_TRUE(is_colour(whole, 202 + 99, 153, red));
    EXPECT_TRUE(is_colour(whole, 202 + 99, 350, red));
    EXPECT_TRUE(is_colour(whole, 202 + 70, 250, white));
}

TEST(Panels, LettersStandAboveEachPictureAndDiffer)
{
    const Image part(600, 300, blue);
    const Image with = panels({{part, ""}, {part, ""}, {part, ""}}, {.columns = 2, .width = 1212});
    const Image without = panels({{part, ""}, {part, ""}, {part, ""}},
                                 {.columns = 2, .width = 1212, .letters = false});
    const int column = panel_width({.columns = 2, .width = 1212}), gap = 12;
    ASSERT_EQ(column, 600);
    const int above = (with.height - without.height) / 2;
    EXPECT_GT(above, 20);
    const int a = dark_pixels(with, 0, 0, 200, above);
    const int b = dark_pixels(with, column + gap, 0, column + gap + 200, above);
    const int c = dark_pixels(with, 0, above + 300 + gap, 200, 2 * above + 300 + gap);
    for (int letter : {a, b, c}) EXPECT_GT(letter, 50);
    EXPECT_NE(a, b);
    EXPECT_NE(b, c);
    EXPECT_EQ(dark_pixels(with, 300, 0, column, above), 0);
    // and nothing is drawn over the pictures
    for (int y = 0; y < 300; ++y) ASSERT_TRUE(is_colour(with, 30, above + y, blue));
}

TEST(Panels, AMissingPictureLeavesItsPlaceWithANote)
{
    const Image whole = panels({{Image(300, 300, red), ""}, {{}, "no picture of b"}},
                               {.columns = 2, .width = 600, .letters = false});
    const int column = panel_width({.columns = 2, .width = 600});
    EXPECT_EQ(whole.height, column);
    EXPECT_GT(dark_pixels(whole, 600 - column, 100, 600, 200), 50);
    EXPECT_EQ(dark_pixels(whole, 600 - column, 0, 600, 100), 0);
}
