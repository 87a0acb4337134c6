#include "engine/adaptive_curve.h"

#include "engine/error.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace sigmaflow {

namespace {

using Rate = std::function<double(double)>;  // of the stress; 0: jammed

FlowPoint measured(const Rate& rate, double stress, double relative_error = 1e-6)
{
    const double value = rate(stress);
    return {stress, value, relative_error * value, value == 0};
}

/// Viscosity a (1 - phi/phi_J)^-2 with phi_J going from phi_0 to phi_mu (Wyart & Cates 2014).
Rate thickening(double phi)
{
    return [phi](double stress) {
        const double f = std::exp(-1.5 / stress);
        const double jamming = 0.58 * f + 0.65 * (1 - f);
        return phi >= jamming ? 0 : stress * std::pow(1 - phi / jamming, 2);
    };
}

std::vector<FlowPoint> refined(const Rate& rate, const CurveGoal& goal)
{
    std::vector<FlowPoint> points;
    for (double stress : {0.1, 0.4, 1.6, 6.4, 25.6, 100.}) points.push_back(measured(rate, stress));
    for (int round = 0; round < 100; ++round) {
        const CurveTasks tasks = next_curve_tasks(points, goal);
        EXPECT_TRUE(tasks.lengthen.empty());
        if (tasks.insert.empty()) break;
        for (double stress : tasks.insert) points.push_back(measured(rate, stress));
    }
    std::sort(points.begin(), points.end(),
              [](const FlowPoint& a, const FlowPoint& b) { return a.stress < b.stress; });
    return points;
}

/// Largest error of interpolating ln rate over ln stress between flowing points. Towards jamming
/// ln rate diverges: beyond the fastest flow, what is below a tenth of it is left out.
double interpolation_error(const Rate& rate, const std::vector<FlowPoint>& points)
{
    double largest = 0, fastest = 0, at = 0;
    for (double stress = 0.1; stress < 100; stress *= 1.02)
        if (rate(stress) > fastest) fastest = rate(at = stress);
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const FlowPoint &a = points[i], &b = points[i + 1];
        if (a.jammed || b.jammed) continue;
        for (double t = 0.05; t < 1; t += 0.05) {
            const double stress = a.stress * std::pow(b.stress / a.stress, t);
            if (stress > at && rate(stress) < 0.1 * fastest) continue;
            const double guess = (1 - t) * std::log(a.shear_rate) + t * std::log(b.shear_rate);
            largest = std::max(largest, std::abs(std::log(rate(stress)) - guess));
        }
    }
    return largest;
}

}

class Curves : public testing::TestWithParam<double> {};  // volume fraction

TEST_P(Curves, AreMetWithinTheToleranceWithAFewMorePointsThanEqualIntervalsNeed)
{
    const Rate rate = thickening(GetParam());
    const CurveGoal goal{.tolerance = 0.02, .closest = 1.01, .most_points = 200};
    const std::vector<FlowPoint> points = refined(rate, goal);
    const double error = interpolation_error(rate, points);
    EXPECT_LT(error, 2 * goal.tolerance);
    const auto flowing =
        std::count_if(points.begin(), points.end(), [](const FlowPoint& p) { return !p.jammed; });
    const double end = points[static_cast<std::size_t>(flowing) - 1].stress;
    std::vector<FlowPoint> equal;  // known: where the curve ends
    for (int count = 2; equal.empty() || interpolation_error(rate, equal) > error; ++count) {
        equal.clear();
        for (int k = 0; k < count; ++k)
            equal.push_back(measured(rate, 0.1 * std::pow(end / 0.1, k / (count - 1.))));
    }
    EXPECT_LT(static_cast<double>(points.size()), 1.6 * static_cast<double>(equal.size()));
}

INSTANTIATE_TEST_SUITE_P(Shapes, Curves, testing::Values(0.5, 0.56, 0.6));

TEST(AdaptiveCurve, BracketsTheStressOfJamming)
{
    const Rate rate = thickening(0.6);
    const std::vector<FlowPoint> points = refined(rate, {.tolerance = 0.1, .closest = 1.05});
    const auto jammed =
        std::find_if(points.begin(), points.end(), [](const FlowPoint& p) { return p.jammed; });
    ASSERT_NE(jammed, points.end());
    EXPECT_LT(jammed->stress / (jammed - 1)->stress, 1.05 * 1.05);
}

TEST(AdaptiveCurve, LengthensWhatIsUncertain)
{
    const std::vector<FlowPoint> points{
        {1, 0.1, 0.001, false}, {2, 0.1, 0.02, false}, {4, 0, 0, true}};
    const CurveTasks tasks = next_curve_tasks(points, {.tolerance = 0.05});
    EXPECT_EQ(tasks.lengthen, std::vector<double>{2});
    EXPECT_EQ(tasks.insert, std::vector<double>{std::sqrt(8)});  // flowing next to jammed
}

// A straight line with noise of known size.
TEST(AdaptiveCurve, NoiseAsksForNoPoints)
{
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    int inserted = 0;
    for (int trial = 0; trial < 200; ++trial) {
        std::vector<FlowPoint> points;
        for (double stress = 1; stress < 100; stress *= 1.5)
            points.push_back({stress, stress * (1 + 0.04 * normal(random)), 0.04 * stress, false});
        inserted += static_cast<int>(next_curve_tasks(points, {}).insert.size());
    }
    EXPECT_LT(inserted, 10);
}

TEST(AdaptiveCurve, KeepsToTheMostPointsAndRefusesNonsense)
{
    const Rate rate = thickening(0.6);
    EXPECT_LE(refined(rate, {.tolerance = 1e-4, .closest = 1.001, .most_points = 12}).size(), 12u);
    const std::vector<FlowPoint> points{{1, 1, 0, false}, {2, 2, 0, false}};
    EXPECT_THROW(next_curve_tasks(points, {.tolerance = 0}), Error);
    EXPECT_THROW(next_curve_tasks(std::span(points).first(1), {}), Error);
    EXPECT_THROW(next_curve_tasks(std::vector<FlowPoint>{{1, 1}, {1, 1}}, {}), Error);
}

}
