#include "engine/wyart_cates.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace sigmaflow {

namespace {

const std::vector<WyartCates> models{
    {.onset_stress = 1.45, .frictional_fraction = 0.58, .frictionless_fraction = 0.65},
    {.onset_stress = 0.05,
     .frictional_fraction = 0.594,
     .frictionless_fraction = 0.713,
     .amplitude = 0.6,
     .exponent = 2.5},
    {.onset_stress = 3,
     .frictional_fraction = 0.56,
     .frictionless_fraction = 0.64,
     .amplitude = 2,
     .exponent = 1.6,
     .sharpness = 1.7}};

/// Stresses from 1e-3 to 1e3 times the onset.
std::vector<double> stresses(const WyartCates& m, int count)
{
    std::vector<double> result;
    for (int k = 0; k <= count; ++k)
        result.push_back(m.onset_stress * std::pow(10, -3 + 6. * k / count));
    return result;
}

/// By looking at the shear rates alone.
CurveShape shape_by_eye(const WyartCates& m, double volume_fraction)
{
    bool falls = false;
    double before = 0;
    for (double stress : stresses(m, 4000)) {
        const double rate = shear_rate(m, volume_fraction, stress);
        if (rate == 0) return CurveShape::arch;
        falls |= rate < before;
        before = rate;
    }
    return falls ? CurveShape::s_shaped : CurveShape::continuous;
}

}

TEST(WyartCates, BranchesAreThoseOfTheTwoJammingFractions)
{
    for (const WyartCates& m : models) {
        const double phi = 0.5;
        const auto branch = [&](double jamming) {
            return m.amplitude / std::pow(1 - phi / jamming, m.exponent);
        };
        const double low = branch(m.frictionless_fraction), high = branch(m.frictional_fraction);
        EXPECT_NEAR(viscosity(m, phi, 1e-4 * m.onset_stress), low, 1e-9 * low);
        EXPECT_NEAR(viscosity(m, phi, 1e9 * m.onset_stress), high, 1e-4 * high);
        EXPECT_NEAR(frictional_share(m, m.onset_stress), std::exp(-1), 1e-15);
        EXPECT_DOUBLE_EQ(shear_rate(m, phi, 2) * viscosity(m, phi, 2), 2);
    }
    EXPECT_TRUE(std::isinf(viscosity(models[0], 0.6, 100)));
    EXPECT_EQ(shear_rate(models[0], 0.6, 100), 0);
    EXPECT_TRUE(std::isinf(thickening_slope(models[0], 0.6, 100)));
}

TEST(WyartCates, SlopeIsTheDerivativeOfTheViscosity)
{
    for (const WyartCates& m : models) {
        for (double phi : {0.3, 0.5, 0.555}) {
            for (double stress : {0.1 * m.onset_stress, m.onset_stress, 7 * m.onset_stress}) {
                constexpr double h = 1e-4;
                const double derivative = (std::log(viscosity(m, phi, stress * std::exp(h))) -
                                           std::log(viscosity(m, phi, stress * std::exp(-h)))) /
                                          (2 * h);
                EXPECT_NEAR(thickening_slope(m, phi, stress), derivative,
                            1e-6 * std::max(1., derivative));
            }
        }
    }
}

TEST(WyartCates, RateFallsExactlyBetweenTheFallingAndTheJammingFraction)
{
    for (const WyartCates& m : models) {
        for (double stress : {0.5 * m.onset_stress, m.onset_stress, 4 * m.onset_stress}) {
            // bisection of d rate/d stress = 0 in the volume fraction
            double low = 0, high = jamming_fraction(m, stress);
            for (int k = 0; k < 60; ++k) {
                const double phi = (low + high) / 2;
                const bool falls =
                    shear_rate(m, phi, stress * 1.000001) < shear_rate(m, phi, stress * 0.999999);
                (falls ? high : low) = phi;
            }
            EXPECT_NEAR(falling_fraction(m, stress), low, 1e-5);
        }
    }
}

TEST(WyartCates, CriticalPointIsWhereTheFirstCurveStopsRising)
{
    for (const WyartCates& m : models) {
        const auto steepest = [&](double phi) {
            double highest = 0;
            for (double stress : stresses(m, 4000))
                highest = std::max(highest, thickening_slope(m, phi, stress));
            return highest;
        };
        double low = 0, high = m.frictional_fraction;
        for (int k = 0; k < 30; ++k) {
            const double phi = (low + high) / 2;
            (steepest(phi) > 1 ? high : low) = phi;
        }
        const auto critical = critical_point(m);
        ASSERT_TRUE(critical);
        EXPECT_NEAR(critical->volume_fraction, low, 1e-6);
        EXPECT_NEAR(thickening_slope(m, low, critical->stress), 1, 1e-4);
        EXPECT_DOUBLE_EQ(critical->shear_rate,
                         shear_rate(m, critical->volume_fraction, critical->stress));
    }
    // far above the onset ln viscosity grows by less than ln stress at any phi below phi_mu
    EXPECT_FALSE(critical_point({.exponent = 0.5}));
    EXPECT_EQ(model_shape({.exponent = 0.5}, 0.579), CurveShape::continuous);
    EXPECT_EQ(shape_by_eye({.exponent = 0.5}, 0.579), CurveShape::continuous);
}

TEST(WyartCates, LargestStressIsWhereTheSuspensionJams)
{
    for (const WyartCates& m : models) {
        for (double share : {0.1, 0.5, 0.9}) {
            const double phi = std::lerp(m.frictional_fraction, m.frictionless_fraction, share);
            double low = 1e-3 * m.onset_stress, high = 1e3 * m.onset_stress;
            for (int k = 0; k < 80; ++k) {
                const double stress = std::sqrt(low * high);
                (shear_rate(m, phi, stress) > 0 ? low : high) = stress;
            }
            EXPECT_NEAR(largest_stress(m, phi) / low, 1, 1e-9);
        }
        EXPECT_TRUE(std::isinf(largest_stress(m, m.frictional_fraction)));
        EXPECT_EQ(largest_stress(m, m.frictionless_fraction), 0);
    }
}

TEST(WyartCates, ShapesAreThoseOfTheRates)
{
    for (const WyartCates& m : models) {
        int s_shaped = 0;
        for (double phi = 0.4; phi < 0.7; phi += 0.0037) {
            EXPECT_EQ(model_shape(m, phi), shape_by_eye(m, phi)) << phi;
            s_shaped += model_shape(m, phi) == CurveShape::s_shaped;
        }
        EXPECT_GT(s_shaped, 1);
    }
}

}
