// tests/render/image_compare_test.cpp -- the yardstick of the picture tests is itself measured.
#include "tests/support/image_compare.h"

#include "tests/render/scenes.h"

#include <gtest/gtest.h>
#include <filesystem>

using namespace sigmaflow;
using render::Image;

TEST(ImageCompare, IdenticalPicturesHaveSimilarityOne)
{
    const Image image = render::render_plot(test::linear_plot());
    EXPECT_DOUBLE_EQ(test::similarity(image, image), 1);
    EXPECT_EQ(test::largest_difference(image, image), 0);
}

TEST(ImageCompare, FlatPicturesFollowTheClosedForm)
{
    const double c1 = 0.01 * 255 * 0.01 * 255;
    const double expected = (2.0 * 100 * 150 + c1) / (100.0 * 100 + 150.0 * 150 + c1);
    EXPECT_NEAR(test::similarity(Image(40, 40, {100, 100, 100}), Image(40, 40, {150, 150, 150})),
                expected, 1e-12);
}

TEST(ImageCompare, SeesAShiftOfTwoPixelsAndAMissingLine)
{
    const Image image = render::render_plot(test::linear_plot());
    Image shifted(image.width, image.height);
    render::paste(shifted, image, 2, 0);
    EXPECT_LT(test::similarity(image, shifted), 0.9);
    render::Plot plot = test::linear_plot();
    plot.series.erase(plot.series.begin());
    EXPECT_LT(test::similarity(image, render::render_plot(plot)), 0.97);
}

TEST(ImageCompare, ForgivesTheLastBitOfColours)
{
    const Image image = render::render_plot(test::log_plot());
    Image noisy = image;
    for (std::size_t i = 0; i < noisy.rgb.size(); i += 7)
        if (noisy.rgb[i] > 0) --noisy.rgb[i];
    EXPECT_GT(test::similarity(image, noisy), 0.995);
    EXPECT_EQ(test::largest_difference(image, noisy), 1);
}

TEST(ImageCompare, AMissingBaselineIsAFailureThatNamesBothFiles)
{
    const auto folder = std::filesystem::path(testing::TempDir()) / "sigmaflow_no_baseline";
    const test::PictureFolders folders{test::usual_folders().baselines, folder};
    const auto result = test::matches_baseline(Image(16, 16), "no_such_baseline", 0.5, folders);
    EXPECT_FALSE(result);
    const std::string message = result.message();
    EXPECT_NE(message.find("images/no_such_baseline.png"), std::string::npos) << message;
    EXPECT_NE(message.find((folder / "no_such_baseline.png").string()), std::string::npos);
    EXPECT_TRUE(std::filesystem::exists(folder / "no_such_baseline.png"));
    std::filesystem::remove_all(folder);
}
