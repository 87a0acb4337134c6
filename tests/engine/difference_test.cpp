#include "engine/difference.h"

#include "engine/error.h"

#include <gtest/gtest.h>
#include <cmath>
#include <random>

namespace sigmaflow {

TEST(Difference, ErrorsAddInSquares)
{
    const Difference d =
        difference({.mean = 2, .standard_error = 0.3}, {.mean = 3, .standard_error = 0.4}, 1);
    EXPECT_DOUBLE_EQ(d.mean, 1);
    EXPECT_DOUBLE_EQ(d.standard_error, 0.5);
    EXPECT_DOUBLE_EQ(d.in_errors, 2);
    EXPECT_TRUE(d.significant);  // beyond 1.96
}

TEST(Difference, SeveralComparisonsAskForMore)
{
    const Estimate a{.mean = 2, .standard_error = 0.3}, b{.mean = 3, .standard_error = 0.4};
    EXPECT_FALSE(difference(a, b, 2).significant);  // 2.24 needed
    EXPECT_FALSE(difference(a, a, 1).significant);
}

TEST(Difference, ExactNumbersDifferOrDoNot)
{
    EXPECT_TRUE(difference({.mean = 1}, {.mean = 2}, 100).significant);
    EXPECT_FALSE(difference({.mean = 1}, {.mean = 1}, 1).significant);
}

TEST(Difference, FalseAlarmsAreAsRareAsPromised)
{
    std::mt19937_64 random(9);
    std::normal_distribution<double> normal;
    constexpr int families = 4000, comparisons = 6;
    int alarms = 0;
    for (int k = 0; k < families; ++k) {
        bool alarm = false;
        for (int i = 0; i < comparisons; ++i)
            alarm |= difference({.mean = normal(random), .standard_error = 1},
                                {.mean = 2 * normal(random), .standard_error = 2}, comparisons)
                         .significant;
        alarms += alarm;
    }
    EXPECT_NEAR(alarms, 0.05 * families, 4 * std::sqrt(0.05 * families));
}

TEST(Difference, RefusesNonsense)
{
    EXPECT_THROW(difference({}, {}, 0), Error);
    EXPECT_THROW(difference({}, {}, 1, 1), Error);
}

}
