#include "engine/histogram.h"

#include "engine/error.h"

#include <gtest/gtest.h>
#include <cmath>
#include <numbers>
#include <random>

namespace sigmaflow {

namespace {

template <class Distribution>
std::vector<std::vector<double>> drawn(Distribution distribution, int frames, int values)
{
    std::mt19937 generator(11);
    std::vector<std::vector<double>> result(frames);
    for (auto& frame : result)
        for (int k = 0; k < values; ++k) frame.push_back(distribution(generator));
    return result;
}

}

TEST(Histogram, DensitiesAreThoseOfTheDistributionWithinTheirErrors)
{
    const auto values = drawn(std::exponential_distribution<double>(1), 200, 500);
    const Histogram h = histogram(values, 0, 4, 20);
    double chi2 = 0, inside = 0;
    for (std::size_t k = 0; k < 20; ++k) {
        const double low = 0.2 * static_cast<double>(k);
        const double expected = (std::exp(-low) - std::exp(-low - 0.2)) / 0.2;
        EXPECT_NEAR(h.centre(k), low + 0.1, 1e-12);
        // independent values: the binomial error
        const double binomial = std::sqrt(expected * 0.2 * (1 - expected * 0.2) / 1e5) / 0.2;
        EXPECT_NEAR(h.standard_error[k], binomial, 0.5 * binomial) << k;
        chi2 += std::pow((h.density[k] - expected) / binomial, 2);
        inside += h.density[k] * h.width;
    }
    EXPECT_LT(chi2, 45);  // 20 +- 6
    EXPECT_GT(chi2, 5);
    EXPECT_NEAR(h.above, std::exp(-4), 5 * std::sqrt(std::exp(-4) / 1e5));
    EXPECT_EQ(h.below, 0);
    EXPECT_NEAR(inside + h.above, 1, 1e-12);
}

TEST(Histogram, FramesThatDifferAsAWholeHaveTheErrorOfTheirNumber)
{
    // every frame has all of its values in one of two bins
    std::mt19937 generator(5);
    std::vector<std::vector<double>> frames;
    for (int k = 0; k < 400; ++k)
        frames.emplace_back(50, std::bernoulli_distribution(0.5)(generator) ? 0.5 : 1.5);
    const Histogram h = histogram(frames, 0, 2, 2);
    EXPECT_NEAR(h.standard_error[0], 0.5 / 20, 0.01);
}

TEST(Histogram, FramesWithoutValuesDoNotCountAndNonsenseIsRefused)
{
    const std::vector<std::vector<double>> frames{{}, {0.5, -1}, {}};
    const Histogram h = histogram(frames, 0, 1, 1);
    EXPECT_EQ(h.frames, 1);
    EXPECT_EQ(h.density[0], 0.5);
    EXPECT_EQ(h.below, 0.5);
    EXPECT_THROW(histogram(frames, 0, 1, 0), Error);
    EXPECT_THROW(histogram(frames, 1, 1, 5), Error);
    const std::vector<std::vector<double>> bad{{std::nan("")}};
    EXPECT_THROW(histogram(bad, 0, 1, 1), Error);
}

}
