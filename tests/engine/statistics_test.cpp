// Oracles: processes whose correlation time and mean are known in closed form, and counting how
// often the truth lies within the error.
#include "engine/statistics.h"

#include "engine/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace sigmaflow {
namespace {

/// x_{t+1} = mean + a (x_t - mean) + sqrt(1 - a^2) noise: variance 1, 2 tau = (1 + a)/(1 - a).
std::vector<double> autoregressive(double a, double mean, int length, unsigned seed)
{
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::vector<double> series;
    double x = normal(random);
    for (int t = 0; t < length; ++t) {
        series.push_back(mean + x);
        x = a * x + std::sqrt(1 - a * a) * normal(random);
    }
    return series;
}

double twice_tau(double a)
{
    return (1 + a) / (1 - a);
}

TEST(EstimateMean, FindsTheCorrelationTimeOfAutoregressiveProcesses)
{
    for (const double a : {0.0, 0.3, 0.8, 0.95}) {
        SCOPED_TRACE(a);
        const int length = 200000;
        const Estimate estimate = estimate_mean(autoregressive(a, 3, length, 11));
        EXPECT_NEAR(2 * estimate.correlation_time / twice_tau(a), 1, 0.1);
        EXPECT_NEAR(estimate.effective_samples * 2 * estimate.correlation_time, length, 1e-6);
        const double expected_error = std::sqrt(twice_tau(a) / length);
        EXPECT_NEAR(estimate.autocorrelation_error / expected_error, 1, 0.05);
        EXPECT_NEAR(estimate.blocking_error / expected_error, 1, 0.15);
        EXPECT_NEAR(estimate.mean, 3, 4 * expected_error);
        EXPECT_TRUE(estimate.reliable);
    }
}

TEST(Autocorrelation, IsThatOfTheProcess)
{
    const double a = 0.9;
    const std::vector<double> rho = autocorrelation(autoregressive(a, 7, 200000, 3), 30);
    ASSERT_EQ(rho.size(), 31u);
    EXPECT_EQ(rho[0], 1);
    for (std::size_t lag = 0; lag < rho.size(); ++lag)
        EXPECT_NEAR(rho[lag], std::pow(a, lag), 0.03) << lag;
}

TEST(Autocorrelation, OfShortAndConstantSeries)
{
    EXPECT_EQ(autocorrelation(std::vector<double>{}, 3), std::vector<double>{});
    EXPECT_EQ(autocorrelation(std::vector<double>{2, 2, 2}, 9), (std::vector<double>{1, 0, 0}));
    EXPECT_EQ(autocorrelation(std::vector<double>{1, -1}, 1), (std::vector<double>{1, -1}));
}

TEST(BlockErrors, RiseFromTheNaiveErrorToTheTrueOne)
{
    const double a = 0.8;
    const int length = 1 << 17;
    const std::vector<BlockError> errors = block_errors(autoregressive(a, 0, length, 4));
    EXPECT_EQ(errors.size(), 17u);
    EXPECT_NEAR(errors.front().error, 1 / std::sqrt(length), 0.02 / std::sqrt(length));
    const double expected = std::sqrt(twice_tau(a) / length);
    for (const BlockError& block : errors)
        if (block.length >= 64 && block.blocks >= 128)
            EXPECT_NEAR(block.error / expected, 1, 4 / std::sqrt(2. * block.blocks))
                << block.length;
    EXPECT_EQ(errors.back().blocks, 2);
}

TEST(EstimateMean, GivesTheTextbookErrorForWhiteNoise)
{
    const int length = 10000;
    const Estimate estimate = estimate_mean(autoregressive(0, -1, length, 5));
    EXPECT_NEAR(estimate.correlation_time, 0.5, 0.05);
    EXPECT_NEAR(estimate.standard_error, 1 / std::sqrt(length), 0.1 / std::sqrt(length));
}

TEST(EstimateMean, TakesTheLargerOfTheTwoErrors)
{
    for (unsigned seed = 0; seed < 20; ++seed) {
        const Estimate estimate = estimate_mean(autoregressive(0.7, 0, 1000, seed));
        EXPECT_GE(estimate.standard_error, estimate.autocorrelation_error);
        EXPECT_GE(estimate.standard_error, estimate.blocking_error);
    }
}

class Coverage : public testing::TestWithParam<double> {};

TEST_P(Coverage, OneStandardErrorContainsTheTruthInTwoThirdsOfTheSeries)
{
    int covered = 0;
    const int realisations = 200;
    for (unsigned seed = 0; seed < realisations; ++seed) {
        const Estimate estimate = estimate_mean(autoregressive(GetParam(), 7, 4000, 1000 + seed));
        EXPECT_TRUE(estimate.reliable);
        covered += std::abs(estimate.mean - 7) <= estimate.standard_error;
    }
    EXPECT_GE(covered, 0.60 * realisations);  // 68.3 % expected, binomial error 3.3 %
    EXPECT_LE(covered, 0.76 * realisations);
}
INSTANTIATE_TEST_SUITE_P(Correlations, Coverage, testing::Values(0.0, 0.5, 0.8, 0.95));

TEST(EstimateMean, ScalesAndShiftsWithTheSeries)
{
    const std::vector<double> series = autoregressive(0.6, 0, 3000, 3);
    std::vector<double> moved;
    for (const double value : series) moved.push_back(100 - 8 * value);
    const Estimate one = estimate_mean(series), two = estimate_mean(moved);
    EXPECT_NEAR(two.mean, 100 - 8 * one.mean, 1e-10);
    EXPECT_NEAR(two.standard_error, 8 * one.standard_error, 1e-10);
    EXPECT_NEAR(two.correlation_time, one.correlation_time, 1e-8);
}

TEST(EstimateMean, DoesNotTrustAConstantSeries)
{
    const Estimate estimate = estimate_mean(std::vector<double>(500, 0.1));
    EXPECT_NEAR(estimate.mean, 0.1, 1e-15);
    EXPECT_EQ(estimate.standard_error, 0);
    EXPECT_EQ(estimate.correlation_time, 0.5);
    EXPECT_EQ(estimate.effective_samples, 1);
    EXPECT_FALSE(estimate.reliable);
}

TEST(EstimateMean, DoesNotTrustVeryShortSeries)
{
    EXPECT_EQ(estimate_mean({}).used, 0);
    EXPECT_FALSE(estimate_mean({}).reliable);
    for (int length = 1; length < 10; ++length) {
        const Estimate estimate = estimate_mean(autoregressive(0, 2, length, 1));
        EXPECT_EQ(estimate.used, length);
        EXPECT_FALSE(estimate.reliable) << length;
        EXPECT_TRUE(std::isfinite(estimate.mean));
        EXPECT_TRUE(std::isfinite(estimate.standard_error));
        EXPECT_GE(estimate.correlation_time, 0.5);
    }
}

TEST(EstimateMean, DoesNotTrustSeriesOfFewCorrelationTimes)
{
    for (unsigned seed = 0; seed < 50; ++seed)  // 2 tau = 1999, 500 samples
        EXPECT_FALSE(estimate_mean(autoregressive(0.999, 0, 500, seed)).reliable) << seed;
}

TEST(EstimateMean, DoesNotTrustADrift)
{
    std::vector<double> series = autoregressive(0, 0, 1000, 2);
    for (std::size_t t = 0; t < series.size(); ++t) series[t] += 0.05 * static_cast<double>(t);
    EXPECT_FALSE(estimate_mean(series).reliable);
}

TEST(EstimateMean, NeverClaimsLessThanTheIndependentErrorWhenNeighboursAnticorrelate)
{
    const Estimate estimate = estimate_mean(autoregressive(-0.8, 0, 5000, 4));
    EXPECT_EQ(estimate.correlation_time, 0.5);
    EXPECT_NEAR(estimate.autocorrelation_error, 1 / std::sqrt(5000), 0.1 / std::sqrt(5000));
}

TEST(EstimateMean, RefusesNumbersThatAreNotFinite)
{
    std::vector<double> series(20, 1.0);
    series[7] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(estimate_mean(series), Error);
    EXPECT_THROW(start_up_cut(series), Error);
}

TEST(StartUpCut, FallsIntoTheExponentialDecay)
{
    const double decay = 60;  // samples; amplitude 20 standard deviations
    int sum = 0, in_window = 0;
    const int realisations = 100;
    for (unsigned seed = 0; seed < realisations; ++seed) {
        std::vector<double> series = autoregressive(0.5, 1, 2000, seed);
        for (std::size_t t = 0; t < series.size(); ++t)
            series[t] += 20 * std::exp(-static_cast<double>(t) / decay);
        const int cut = start_up_cut(series);
        sum += cut;
        // after 2 decay times 2.7 standard deviations are left, after 10 less than 0.001
        in_window += cut >= 2 * decay && cut <= 10 * decay;
        EXPECT_GE(cut, decay) << seed;
        EXPECT_LE(cut, 1000) << seed;
    }
    EXPECT_GE(in_window, 0.9 * realisations);
    EXPECT_GE(sum / realisations, 2 * decay);
    EXPECT_LE(sum / realisations, 8 * decay);
}

TEST(StartUpCut, RemovesTheBiasOfTheStartUp)
{
    double biased = 0, cleaned = 0, error = 0;
    const int realisations = 50;
    for (unsigned seed = 0; seed < realisations; ++seed) {
        std::vector<double> series = autoregressive(0.5, 1, 3000, 77 + seed);
        for (std::size_t t = 0; t < series.size(); ++t)
            series[t] += 10 * std::exp(-static_cast<double>(t) / 50);
        const auto cut = static_cast<std::size_t>(start_up_cut(series));
        biased += estimate_mean(series).mean - 1;
        const Estimate estimate = estimate_mean(std::span(series).subspan(cut));
        cleaned += estimate.mean - 1;
        error += estimate.standard_error;
    }
    EXPECT_GT(biased, 3 * error);
    EXPECT_LT(std::abs(cleaned), 0.5 * error);
}

TEST(StartUpCut, KeepsNearlyAllOfAStationarySeries)
{
    double sum = 0;
    const int realisations = 100, length = 2000;
    for (unsigned seed = 0; seed < realisations; ++seed)
        sum += start_up_cut(autoregressive(0.5, 1, length, 500 + seed));
    EXPECT_LT(sum / realisations, 0.15 * length);
}

TEST(StartUpCut, FindsAJumpInALongSeriesToTwoPercentOfItsLength)
{
    std::vector<double> series = autoregressive(0.3, 0, 40000, 9);
    for (std::size_t t = 0; t < 10000; ++t) series[t] += 30;
    EXPECT_NEAR(start_up_cut(series), 10000, 800);
    EXPECT_GE(start_up_cut(series), 10000 - 20);
}

TEST(StartUpCut, NeverTakesMoreThanHalf)
{
    for (int length = 0; length < 60; ++length) {
        std::vector<double> ramp;
        for (int t = 0; t < length; ++t) ramp.push_back(t * t);
        EXPECT_LE(start_up_cut(ramp), length / 2) << length;
        EXPECT_GE(start_up_cut(ramp), 0) << length;
    }
    EXPECT_EQ(start_up_cut(std::vector<double>(100, 4.0)), 0);
}

}
}
