#include "engine/random.h"

#include <gtest/gtest.h>
#include <cmath>

namespace sigmaflow {

// Known answers published with Random123 (kat_vectors, philox4x32 10).
TEST(Philox, GivesThePublishedAnswers)
{
    EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}),
              (Philox{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
    EXPECT_EQ(philox({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}),
              (Philox{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
    EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
              (Philox{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Philox, UniformNumbersHaveTheMomentsOfTheUniformDistribution)
{
    constexpr int n = 100000;
    double mean = 0, square = 0, product = 0;
    for (int k = 0; k < n; ++k) {
        const double u = uniform(7, 0, k), v = uniform(7, 1, k);
        EXPECT_GE(u, 0);
        EXPECT_LT(u, 1);
        mean += u / n;
        square += u * u / n;
        product += (u - 0.5) * (v - 0.5) / n;
    }
    EXPECT_NEAR(mean, 0.5, 5 * std::sqrt(1. / 12 / n));
    EXPECT_NEAR(square, 1. / 3, 5 * std::sqrt(4. / 45 / n));
    EXPECT_NEAR(product, 0, 5. / 12 / std::sqrt(n));
}

}
