// tests/render/ticks_test.cpp -- tables of what a person would write on an axis.
#include "render/ticks.h"

#include <gtest/gtest.h>

using namespace sigmaflow::render;
using Labels = std::vector<std::string>;

namespace {

Labels labels(const std::vector<Tick>& ticks)
{
    Labels found;
    for (const Tick& tick : ticks)
        if (!tick.label.empty()) found.push_back(tick.label);
    return found;
}

}

TEST(Ticks, LinearAxes)
{
    EXPECT_EQ(labels(linear_ticks({0, 1})), (Labels{"0.0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
    EXPECT_EQ(labels(linear_ticks({0, 12})), (Labels{"0", "2", "4", "6", "8", "10", "12"}));
    EXPECT_EQ(labels(linear_ticks({-0.5, 0.5})), (Labels{"−0.4", "−0.2", "0.0", "0.2", "0.4"}));
    EXPECT_EQ(labels(linear_ticks({-0.6, 0.6})),
              (Labels{"−0.6", "−0.4", "−0.2", "0.0", "0.2", "0.4", "0.6"}));
    EXPECT_EQ(labels(linear_ticks({0, 15})),
              (Labels{"0.0", "2.5", "5.0", "7.5", "10.0", "12.5", "15.0"}));
    EXPECT_EQ(labels(linear_ticks({0, 0.03})),
              (Labels{"0.000", "0.005", "0.010", "0.015", "0.020", "0.025", "0.030"}));
    EXPECT_EQ(labels(linear_ticks({97, 103})),
              (Labels{"97", "98", "99", "100", "101", "102", "103"}));
}

TEST(Ticks, LargeAndSmallNumbersSharePowersOfTen)
{
    EXPECT_EQ(labels(linear_ticks({0, 2e6}, 4)),
              (Labels{"0", "0.5×10^{6}", "1.0×10^{6}", "1.5×10^{6}", "2.0×10^{6}"}));
    EXPECT_EQ(labels(linear_ticks({-2e-7, 2e-7}, 4)),
              (Labels{"−2×10^{−7}", "−1×10^{−7}", "0", "1×10^{−7}", "2×10^{−7}"}));
}

TEST(Ticks, MinorTicksDivideTheStepsEvenly)
{
    const std::vector<Tick> ticks = linear_ticks({0, 1});  // 0.2 in four parts
    ASSERT_EQ(ticks.size(), 21u);
    for (std::size_t i = 0; i < ticks.size(); ++i) {
        EXPECT_NEAR(ticks[i].value, 0.05 * i, 1e-12);
        EXPECT_EQ(ticks[i].label.empty(), i % 4 != 0);
    }
    EXPECT_EQ(linear_ticks({0, 0.5}).size(), 26u);  // 0.1 in five parts
}

TEST(Ticks, LogarithmicAxesOverDecades)
{
    EXPECT_EQ(labels(log_ticks({0.1, 100})), (Labels{"10^{−1}", "1", "10", "10^{2}"}));
    EXPECT_EQ(log_ticks({1, 100}).size(), 19u);  // 1..9, 10..90, 100
    EXPECT_EQ(labels(log_ticks({1e-12, 1e4})),
              (Labels{"10^{−12}", "10^{−10}", "10^{−8}", "10^{−6}", "10^{−4}", "10^{−2}", "1",
                      "10^{2}", "10^{4}"}));
}

TEST(Ticks, ShortLogarithmicAxesHaveOneTwoFive)
{
    EXPECT_EQ(labels(log_ticks({1, 50})), (Labels{"1", "2", "5", "10", "20", "50"}));
    EXPECT_EQ(labels(log_ticks({0.015, 0.3})), (Labels{"0.02", "0.05", "0.1", "0.2"}));
    EXPECT_EQ(labels(log_ticks({1e-6, 5e-6})), (Labels{"10^{−6}", "2×10^{−6}", "5×10^{−6}"}));
    // Too short even for these: as on a linear axis.
    EXPECT_EQ(labels(log_ticks({1.2, 1.8})), (Labels{"1.2", "1.4", "1.6", "1.8"}));
}

TEST(Ticks, IntegerAxesShowWholeNumbersOnly)
{
    EXPECT_EQ(labels(integer_ticks({0, 5})), (Labels{"0", "1", "2", "3", "4", "5"}));
    EXPECT_EQ(labels(integer_ticks({0, 1})), (Labels{"0", "1"}));
    EXPECT_EQ(labels(integer_ticks({0, 10})), (Labels{"0", "2", "4", "6", "8", "10"}));
    EXPECT_EQ(labels(integer_ticks({0, 20})), (Labels{"0", "5", "10", "15", "20"}));
}

TEST(Ticks, RangesGrowToRoundEnds)
{
    const auto expect = [](Range found, double from, double to) {
        EXPECT_NEAR(found.from, from, 1e-9 * (to - from));
        EXPECT_NEAR(found.to, to, 1e-9 * (to - from));
    };
    expect(round_linear_range({0, 12}), 0, 12);
    expect(round_linear_range({0.013, 0.97}), 0, 1);
    expect(round_linear_range({-0.48, 0.51}), -0.5, 0.55);
    expect(round_linear_range({5, 5}), 2.5, 7.5);
    expect(round_linear_range({0, 0}), -1, 1);
    expect(round_log_range({0.13, 79}), 0.1, 100);
    expect(round_log_range({0.002, 1.8}), 0.002, 2);
    expect(round_log_range({1, 1000}), 1, 1000);
    expect(round_log_range({3, 3}), 1.5, 6);
}

TEST(Ticks, NegativeZeroAndMinusSigns)
{
    EXPECT_EQ(fixed_label(-0.0001, 2), "0.00");
    EXPECT_EQ(fixed_label(-1.25, 2), "−1.25");
    EXPECT_EQ(power_label(-1), "10^{−1}");
}
