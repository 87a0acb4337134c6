#include "engine/ensemble.h"

#include "engine/error.h"

#include <gtest/gtest.h>
#include <cmath>
#include <random>

namespace sigmaflow {

namespace {

using Members = std::vector<std::vector<double>>;

double root_mean_square(const std::vector<double>& values, double about)
{
    double sum = 0;
    for (double value : values) sum += (value - about) * (value - about);
    return std::sqrt(sum / static_cast<double>(values.size()));
}

}

TEST(Ensemble, TheMeanOfThreeAndItsErrorAreThoseOfTheTextbook)
{
    const EnsembleMean result = ensemble_mean(Members{{1, 5}, {2, 5}, {6, 5}});
    EXPECT_EQ(result.mean, (std::vector<double>{3, 5}));
    EXPECT_DOUBLE_EQ(result.standard_error[0], std::sqrt(14. / 6));
    EXPECT_EQ(result.standard_error[1], 0);
}

TEST(Ensemble, OneMemberHasNoError)
{
    EXPECT_EQ(ensemble_mean(Members{{4}}).standard_error, std::vector<double>{0});
    EXPECT_EQ(ensemble_ratio(Members{{4}}, Members{{2}}).mean, std::vector<double>{2});
}

// Each strain is an ensemble of its own: the errors must be the scatter of the means.
TEST(Ensemble, ErrorsAreTheScatterOverManyEnsembles)
{
    constexpr int members = 20, ensembles = 4000;
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal;
    Members rate(members), stress(members);
    for (int i = 0; i < members; ++i)
        for (int k = 0; k < ensembles; ++k) {
            const double common = normal(random);
            rate[i].push_back(4 + common);
            stress[i].push_back(8 + 1.5 * common + 0.5 * normal(random));
        }
    const EnsembleMean mean = ensemble_mean(rate), ratio = ensemble_ratio(stress, rate);
    EXPECT_NEAR(root_mean_square(mean.mean, 4), 1 / std::sqrt(20), 0.03 / std::sqrt(20));
    EXPECT_NEAR(root_mean_square(mean.standard_error, 0), 1 / std::sqrt(20), 0.03 / std::sqrt(20));
    const double scatter = root_mean_square(ratio.mean, 2);
    EXPECT_NEAR(root_mean_square(ratio.standard_error, 0), scatter, 0.05 * scatter);
    // they hang together: as independent errors they would be far larger
    EXPECT_LT(scatter, 0.5 * 2 * std::hypot(1 / 4., 1.58 / 8) / std::sqrt(20));
}

TEST(Ensemble, RefusesMembersThatDoNotFit)
{
    EXPECT_THROW(ensemble_mean(Members{}), Error);
    EXPECT_THROW(ensemble_mean(Members{{1, 2}, {1}}), Error);
    EXPECT_THROW(ensemble_ratio(Members{{1}}, Members{{1}, {2}}), Error);
    EXPECT_THROW(ensemble_ratio(Members{{1}}, Members{{0}}), Error);
}

}
