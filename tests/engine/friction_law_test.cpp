#include "engine/friction_law.h"

#include "engine/error.h"

#include <gtest/gtest.h>
#include <cmath>
#include <random>
#include <vector>

namespace sigmaflow {

namespace {

std::vector<FrictionPoint> points(double onset, double share, double error)
{
    std::vector<FrictionPoint> result;
    for (double stress : {0.2, 0.5, 1., 2., 5., 20.})
        result.push_back({stress, share * std::exp(-onset / stress), error});
    return result;
}

}

TEST(FrictionLaw, ExactPointsGiveBackTheLaw)
{
    for (double onset : {0.1, 1., 5.}) {
        const FrictionLaw law = fit_friction_law(points(onset, 0.5, 0.01));
        EXPECT_NEAR(law.onset_stress.mean, onset, 1e-6 * onset);
        EXPECT_NEAR(law.share.mean, 0.5, 1e-6);
        EXPECT_NEAR(law.chi2_per_degree, 0, 1e-9);
        EXPECT_NEAR(law.fraction(3), 0.5 * std::exp(-onset / 3), 1e-6);
    }
}

TEST(FrictionLaw, ErrorsAreTheScatterOfFitsToNoisyPoints)
{
    std::mt19937_64 random(2);
    std::normal_distribution<double> normal;
    double onset2 = 0, share2 = 0, chi2 = 0;
    constexpr int trials = 400;
    for (int k = 0; k < trials; ++k) {
        std::vector<FrictionPoint> noisy = points(1, 0.5, 0.02);
        for (FrictionPoint& p : noisy)
            p.fraction = std::max(0., p.fraction + p.standard_error * normal(random));
        const FrictionLaw law = fit_friction_law(noisy);
        onset2 += std::pow((law.onset_stress.mean - 1) / law.onset_stress.standard_error, 2);
        share2 += std::pow((law.share.mean - 0.5) / law.share.standard_error, 2);
        chi2 += law.chi2_per_degree;
    }
    EXPECT_NEAR(onset2 / trials, 1, 0.3);
    EXPECT_NEAR(share2 / trials, 1, 0.3);
    EXPECT_NEAR(chi2 / trials, 1, 0.2);
}

TEST(FrictionLaw, RefusesWhatCannotBeFitted)
{
    EXPECT_THROW(fit_friction_law(std::vector<FrictionPoint>{{1, 0.5, 0.1}}), Error);
    EXPECT_THROW(fit_friction_law(std::vector<FrictionPoint>{{1, 0.5, 0.1}, {1, 0.4, 0.1}}), Error);
    EXPECT_THROW(fit_friction_law(std::vector<FrictionPoint>{{1, 0.5, 0}, {2, 0.4, 0.1}}), Error);
    EXPECT_THROW(fit_friction_law(std::vector<FrictionPoint>{{1, 0, 0.1}, {2, 0.4, 0.1}}), Error);
}

}
