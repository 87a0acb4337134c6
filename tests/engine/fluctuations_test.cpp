#include "engine/fluctuations.h"

#include "engine/error.h"
#include "tests/support/random_state.h"

#include <gtest/gtest.h>
#include <cmath>
#include <vector>

namespace sigmaflow {

namespace {

double normal(support::Random& random)
{
    double sum = -6;  // of twelve uniform numbers: variance 1
    for (int k = 0; k < 12; ++k) sum += random.uniform(0, 1);
    return sum;
}

/// x' = a x + noise, variance 1/(1 - a^2)
std::vector<double> autoregressive(double a, int n, unsigned seed)
{
    support::Random random(seed);
    std::vector<double> series;
    double x = normal(random) / std::sqrt(1 - a * a);
    for (int k = 0; k < n; ++k) series.push_back(x = a * x + normal(random));
    return series;
}

}

TEST(Fluctuations, VarianceOfACorrelatedSeriesIsWithinItsError)
{
    constexpr double a = 0.8, expected = 1 / (1 - a * a);
    double pull2 = 0, mean = 0;
    constexpr int trials = 200;
    for (unsigned seed = 0; seed < trials; ++seed) {
        const Fluctuations f = fluctuations(autoregressive(a, 2000, seed));
        pull2 += std::pow((f.variance - expected) / f.variance_error, 2) / trials;
        mean += f.variance / trials;
    }
    EXPECT_NEAR(mean, expected, 0.02 * expected);
    EXPECT_GT(pull2, 0.6);  // the error is neither too large
    EXPECT_LT(pull2, 1.6);  // nor too small
}

TEST(Fluctuations, SkewnessOfKnownSeries)
{
    EXPECT_EQ(fluctuations(std::vector<double>(10, 3.)).skewness, 0);
    EXPECT_NEAR(fluctuations(std::vector<double>{0, 0, 0, 1, 0, 0, 0, 1}).skewness,
                (0.75 - 0.25) / std::sqrt(0.1875), 1e-12);  // Bernoulli, p = 1/4
    EXPECT_NEAR(fluctuations(std::vector<double>{1, 2, 3, 4, 5}).skewness, 0, 1e-12);
}

// Rare large excursions: an exponential distribution has skewness 2 and excess kurtosis 6.
TEST(Fluctuations, KurtosisTellsNormalFromIntermittentSeries)
{
    const Fluctuations calm = fluctuations(autoregressive(0, 20000, 1));
    EXPECT_NEAR(calm.kurtosis, -0.1, 4 * calm.kurtosis_error);  // of a sum of twelve
    EXPECT_NEAR(calm.skewness, 0, 4 * calm.skewness_error);
    support::Random random(2);
    std::vector<double> series;
    for (int k = 0; k < 200000; ++k) series.push_back(-std::log(1 - random.uniform(0, 1)));
    const Fluctuations wild = fluctuations(series);
    EXPECT_NEAR(wild.skewness, 2, 0.1);
    EXPECT_NEAR(wild.kurtosis, 6, 0.8);
    EXPECT_NEAR(calm.kurtosis_error, std::sqrt(24. / 20000), 0.2 * std::sqrt(24. / 20000));
}

TEST(PowerLaw, FindsTheExponentWithItsError)
{
    const std::vector<double> x{500, 2000, 4500};
    const PowerLaw exact = fit_power_law(x, std::vector<double>{0.2, 0.05, 0.1 / 4.5},
                                         std::vector<double>{0.01, 0.003, 0.002});
    EXPECT_NEAR(exact.exponent, -1, 1e-12);
    EXPECT_NEAR(exact.amplitude, 100, 1e-9);
    EXPECT_NEAR(exact.chi2_per_degree, 0, 1e-20);
    support::Random random(3);
    double pull2 = 0, chi2 = 0;
    constexpr int trials = 2000;
    for (int t = 0; t < trials; ++t) {
        std::vector<double> y, error;
        for (double value : x) {
            y.push_back(100 / value * (1 + 0.02 * normal(random)));
            error.push_back(0.02 * 100 / value);
        }
        const PowerLaw law = fit_power_law(x, y, error);
        pull2 += std::pow((law.exponent + 1) / law.exponent_error, 2) / trials;
        chi2 += law.chi2_per_degree / trials;
    }
    EXPECT_NEAR(pull2, 1, 0.1);
    EXPECT_NEAR(chi2, 1, 0.1);
}

TEST(PowerLaw, RefusesWhatHasNoLogarithmOrNoSlope)
{
    const std::vector<double> one{1, 1}, two{1, 2};
    EXPECT_THROW(fit_power_law(one, two, two), Error);
    EXPECT_THROW(fit_power_law(two, std::vector<double>{1, -1}, two), Error);
    EXPECT_THROW(fit_power_law(two, two, std::vector<double>{1, 0}), Error);
    EXPECT_THROW(fit_power_law(two, std::vector<double>{1}, two), Error);
}

}
