#include "engine/flow_curve.h"

#include "engine/error.h"
#include "tests/support/random_state.h"

#include <gtest/gtest.h>
#include <cmath>
#include <functional>

namespace sigmaflow {

namespace {

std::vector<FlowPoint> curve(const std::function<double(double)>& rate, double error)
{
    std::vector<FlowPoint> points;
    for (double stress : {0.3, 0.5, 1., 2., 3., 5., 10., 20.})
        points.push_back({stress, rate(stress), error, false});
    return points;
}

double rising(double s)
{
    return 0.1 * s;
}
// Wyart & Cates: viscosity between two branches with the share exp(-1/s) of frictional contacts
double s_shaped(double s)
{
    const double f = std::exp(-1 / s), jamming = 0.646 * (1 - f) + 0.5815 * f;
    return s * std::pow(1 - 0.575 / jamming, 2);
}
double arch(double s)
{
    const double f = std::exp(-1 / s), jamming = 0.646 * (1 - f) + 0.575 * f;
    return s * std::pow(std::max(0., 1 - 0.58 / jamming), 2);
}

CurveShape shape(const std::vector<FlowPoint>& points)
{
    return analyse_flow_curve(points).shape;
}

}

TEST(FlowCurve, ShapesOfCurvesWithoutErrors)
{
    EXPECT_EQ(shape(curve(rising, 0)), CurveShape::continuous);
    EXPECT_EQ(shape(curve(s_shaped, 0)), CurveShape::s_shaped);
    ASSERT_TRUE(analyse_flow_curve(curve(s_shaped, 0)).fall);
    EXPECT_GT(analyse_flow_curve(curve(s_shaped, 0)).fall->from, 0.3);
    auto points = curve(arch, 0);
    for (FlowPoint& p : points) p.jammed = p.shear_rate == 0;
    ASSERT_TRUE(points.back().jammed);
    const CurveAnalysis jams = analyse_flow_curve(points);
    EXPECT_EQ(jams.shape, CurveShape::arch);
    EXPECT_TRUE(jams.jams);
    EXPECT_GT(jams.jamming_stress, 1);
    std::reverse(points.begin(), points.end());  // the order does not matter
    EXPECT_EQ(analyse_flow_curve(points).jamming_stress, jams.jamming_stress);
    // falls up to the highest stress without jamming: what comes behind it is open
    EXPECT_EQ(shape(curve([](double s) { return s < 2 ? s : 4 / s; }, 0)), CurveShape::undecided);
}

TEST(FlowCurve, ErrorsThatHideTheShapeLeaveItUndecided)
{
    EXPECT_EQ(shape(curve(rising, 10)), CurveShape::undecided);
    EXPECT_EQ(shape(curve(s_shaped, 10)), CurveShape::undecided);
    EXPECT_EQ(shape(curve([](double) { return 1.; }, 0)), CurveShape::undecided);
}

TEST(FlowCurve, IntervalsAreThoseOfTheNormalDistribution)
{
    EXPECT_NEAR(two_sided_quantile(0.05), 1.959963985, 1e-9);  // tables
    EXPECT_NEAR(two_sided_quantile(0.05 / 7), 2.690110, 1e-6);
    EXPECT_NEAR(two_sided_quantile(0.3173105079), 1, 1e-9);
    const std::vector<FlowPoint> points{{1, 2, 0.3, false}, {3, 4, 0.4, false}};
    const Slope s = analyse_flow_curve(points).slopes.at(0);
    EXPECT_DOUBLE_EQ(s.slope, 1);
    EXPECT_NEAR(s.upper - s.slope, 1.959963985 * 0.5 / 2, 1e-9);
    EXPECT_NEAR(s.slope - s.lower, 1.959963985 * 0.5 / 2, 1e-9);
}

// With a flat curve every "falls" is wrong.
TEST(FlowCurve, ErrorRateIsAtMostWhatTheConfidenceAllows)
{
    support::Random random(11);
    constexpr int trials = 4000;
    int wrong = 0;
    for (int trial = 0; trial < trials; ++trial) {
        auto points = curve([](double) { return 1.; }, 0.1);
        for (FlowPoint& p : points) {
            double normal = -6;  // the sum of twelve uniform numbers
            for (int k = 0; k < 12; ++k) normal += random.uniform(0, 1);
            p.shear_rate += 0.1 * normal;
        }
        wrong += analyse_flow_curve(points).fall.has_value();
    }
    EXPECT_LT(wrong, 0.03 * trials);   // half of 5 %: only falls
    EXPECT_GT(wrong, 0.007 * trials);  // and the test is not blind
}

TEST(FlowCurve, RefusesWhatIsNoCurve)
{
    const auto refused = [](const std::vector<FlowPoint>& points, double confidence = 0.95) {
        EXPECT_THROW(analyse_flow_curve(points, confidence), Error);
    };
    refused({{1, 1, 0, false}});
    refused({{1, 1, 0, false}, {1, 2, 0, false}});
    refused({{1, 1, 0, false}, {2, std::nan(""), 0, false}});
    refused({{1, 1, -1, false}, {2, 1, 0, false}});
    refused({{1, 1, 0, false}, {2, 1, 0, false}}, 1);
}

}
