// tests/render/image_test.cpp
#include "render/image.h"

#include <gtest/gtest.h>

using namespace sigmaflow::render;

TEST(Image, ShrinkingTakesMeans)
{
    Image image(4, 2, {0, 0, 0});
    image.pixel(0, 0)[0] = 100;
    image.pixel(1, 1)[0] = 200;
    image.pixel(3, 1)[2] = 40;
    const Image small = shrink(image, 2);
    ASSERT_EQ(small.width, 2);
    ASSERT_EQ(small.height, 1);
    EXPECT_EQ(small.pixel(0, 0)[0], 75);
    EXPECT_EQ(small.pixel(1, 0)[2], 10);
}

TEST(Image, PastingCutsWhatLiesOutside)
{
    Image whole(3, 3, {0, 0, 0});
    const Image part(3, 3, {9, 8, 7});
    paste(whole, part, -2, 1);
    EXPECT_EQ(whole.pixel(0, 1)[1], 8);
    EXPECT_EQ(whole.pixel(0, 2)[1], 8);
    EXPECT_EQ(whole.pixel(0, 0)[1], 0);
    EXPECT_EQ(whole.pixel(1, 1)[1], 0);
    paste(whole, part, 5, 5);  // misses it altogether
    EXPECT_EQ(whole.pixel(2, 2)[0], 0);
}

TEST(Image, SideBySideAndStackedCentreTheSmallerPictures)
{
    const Image small(2, 2, {1, 1, 1}), large(3, 6, {2, 2, 2});
    const Image row = side_by_side({small, large}, 4);
    ASSERT_EQ(row.width, 2 + 4 + 3);
    ASSERT_EQ(row.height, 6);
    EXPECT_EQ(row.pixel(0, 0)[0], 255);
    EXPECT_EQ(row.pixel(0, 2)[0], 1);
    EXPECT_EQ(row.pixel(3, 3)[0], 255);
    EXPECT_EQ(row.pixel(6, 0)[0], 2);
    const Image column = stacked({large, small}, 1);
    ASSERT_EQ(column.width, 3);
    ASSERT_EQ(column.height, 6 + 1 + 2);
    EXPECT_EQ(column.pixel(1, 8)[0], 1);
    EXPECT_EQ(column.pixel(1, 6)[0], 255);
}
