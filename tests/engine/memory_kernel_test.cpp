#include "engine/memory_kernel.h"

#include "engine/error.h"

#include <gtest/gtest.h>
#include <cmath>
#include <functional>
#include <random>

namespace sigmaflow {

namespace {

std::vector<double> strains(int count, double spacing)
{
    std::vector<double> x;
    for (int k = 0; k < count; ++k) x.push_back(k * spacing);
    return x;
}

std::vector<double> values(const std::vector<double>& x, const std::function<double(double)>& f)
{
    std::vector<double> y;
    for (double one : x) y.push_back(f(one));
    return y;
}

double slow_and_fast(double x)
{
    return 300 - 180 * std::exp(-x / 0.02) - 90 * std::exp(-x / 0.0017);
}

/// One exponential to which a stationary noise is added whose correlation decays over ten samples:
/// what the viscosity of one small suspension does after a step.
std::vector<std::vector<double>> ensemble(const std::vector<double>& x, int members, unsigned seed,
                                          const std::function<double(double)>& f, double noise)
{
    std::mt19937 generator(seed);
    std::normal_distribution<double> normal;
    const double keep = std::exp(-0.1);
    std::vector<std::vector<double>> result;
    for (int m = 0; m < members; ++m) {
        double deviation = noise * normal(generator);
        std::vector<double> y;
        for (double one : x) {
            y.push_back(f(one) + deviation);
            deviation = keep * deviation + noise * std::sqrt(1 - keep * keep) * normal(generator);
        }
        result.push_back(std::move(y));
    }
    return result;
}

}

TEST(Relaxation, ExactExponentialsAreFound)
{
    const std::vector<double> x = strains(400, 2.5e-4), error(400, 0.1);
    const Relaxation one = fit_relaxation(
        x, values(x, [](double s) { return 5 + 2 * std::exp(-s / 0.023); }), error, 1);
    ASSERT_EQ(one.terms.size(), 1u);
    EXPECT_NEAR(one.terms[0].relaxation_strain.mean, 0.023, 1e-8);
    EXPECT_NEAR(one.terms[0].amplitude.mean, 2, 1e-6);
    EXPECT_NEAR(one.plateau.mean, 5, 1e-6);
    EXPECT_NEAR(one.initial.mean, 7, 1e-6);

    const Relaxation two = fit_relaxation(x, values(x, slow_and_fast), error, 2);
    ASSERT_EQ(two.terms.size(), 2u);
    EXPECT_TRUE(two.resolved);
    EXPECT_NEAR(two.terms[0].relaxation_strain.mean, 0.02, 1e-7);
    EXPECT_NEAR(two.terms[1].relaxation_strain.mean, 0.0017, 1e-7);
    EXPECT_NEAR(two.terms[0].amplitude.mean, -180, 1e-3);
    EXPECT_NEAR(two.terms[1].amplitude.mean, -90, 1e-3);
    EXPECT_NEAR(two.at(0.01), slow_and_fast(0.01), 1e-5);
    EXPECT_LT(two.aic, fit_relaxation(x, values(x, slow_and_fast), error, 1).aic);
}

// NIST Statistical Reference Datasets, Misra1a: y = b1 (1 - exp(-b2 x)), certified b1 =
// 238.94212918 +- 2.7070075241, b2 = 5.5015643181e-4 +- 7.2668688436e-6, residual standard
// deviation 0.10187876330.
TEST(Relaxation, CertifiedValuesAndErrorsAreReproduced)
{
    const std::vector<double> x{77.6,  114.9, 141.1, 190.8, 239.9, 289.0, 332.8,
                                378.4, 434.8, 477.3, 536.8, 593.1, 689.1, 760.0},
        y{10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02,
          44.82, 50.76, 55.05, 61.01, 66.40, 75.47, 81.78},
        error(14, 0.10187876330);
    const Relaxation fit = fit_relaxation(x, y, error, 1, {.initial = 0., .plateau = std::nullopt});
    const Value b2 = fit.terms[0].relaxation_strain;
    EXPECT_NEAR(1 / b2.mean, 5.5015643181e-4, 1e-9);
    EXPECT_NEAR(fit.plateau.mean, 238.94212918, 1e-4);
    EXPECT_NEAR(fit.plateau.standard_error, 2.7070075241, 1e-4);
    EXPECT_NEAR(b2.standard_error / b2.mean / b2.mean, 7.2668688436e-6, 1e-10);
    EXPECT_NEAR(fit.chi2_per_degree, 1, 1e-6);
    EXPECT_NEAR(fit.aic, 12 + 4, 1e-5);
    EXPECT_NEAR(fit.initial.mean, 0, 1e-10);
    EXPECT_NEAR(fit.initial.standard_error, 0, 1e-10);
    const Relaxation both =
        fit_relaxation(x, y, error, 1, {.initial = 0., .plateau = 238.94212918});
    EXPECT_NEAR(1 / both.terms[0].relaxation_strain.mean, 5.5015643181e-4, 1e-9);
    EXPECT_EQ(both.plateau.standard_error, 0);
}

TEST(Relaxation, BootstrapErrorsCoverTheTruthWhereIndependentErrorsAreTooSmall)
{
    const std::vector<double> x = strains(60, 2e-3);
    const auto truth = [](double s) { return 400 - 250 * std::exp(-s / 0.023); };
    int within = 0, within_naive = 0;
    double worst_chi2 = 0, mean_tau = 0;
    constexpr int trials = 60;
    for (int trial = 0; trial < trials; ++trial) {
        const auto members = ensemble(x, 30, 100 + static_cast<unsigned>(trial), truth, 60);
        const Relaxation fit = fit_relaxation_of_members(x, members, 1, 40, 7);
        const Value strain = fit.terms[0].relaxation_strain;
        within += std::abs(strain.mean - 0.023) < 2 * strain.standard_error;
        worst_chi2 = std::max(worst_chi2, fit.chi2_per_degree);
        mean_tau += fit.correlation_time / trials;
        std::vector<double> mean(x.size(), 0.), error(x.size(), 60 / std::sqrt(30.));
        for (const auto& member : members)
            for (std::size_t k = 0; k < x.size(); ++k) mean[k] += member[k] / 30;
        const Value naive = fit_relaxation(x, mean, error, 1).terms[0].relaxation_strain;
        within_naive += std::abs(naive.mean - 0.023) < 2 * naive.standard_error;
    }
    EXPECT_GE(within, 0.85 * trials);  // 95 % of many; less by the scatter of 40 resamples
    EXPECT_LT(within_naive, 0.8 * trials);
    EXPECT_LT(worst_chi2, 5);
    EXPECT_GT(mean_tau, 4);  // 10.5 for an endless series, 60 samples see less
    EXPECT_LT(mean_tau, 12);
}

TEST(Relaxation, TheSmallerNumberOfExponentialsWinsUnlessTheDataAskForMore)
{
    const std::vector<double> x = strains(200, 5e-4);
    const auto single = ensemble(
        x, 40, 5, [](double s) { return 400 - 250 * std::exp(-s / 0.023); }, 40);
    const auto one = fit_relaxation_of_members(x, single, 1, 10, 1);
    EXPECT_EQ(&better_of(one, one), &one);
    const auto one_as_two = fit_relaxation_of_members(x, single, 2, 10, 1);
    EXPECT_EQ(&better_of(one, one_as_two), &one);
    const auto both = ensemble(x, 40, 6, slow_and_fast, 10);
    const auto two_as_one = fit_relaxation_of_members(x, both, 1, 10, 1);
    const auto two = fit_relaxation_of_members(x, both, 2, 10, 1);
    EXPECT_EQ(&better_of(two_as_one, two), &two);
    EXPECT_NEAR(two.terms[1].relaxation_strain.mean, 0.0017,
                4 * two.terms[1].relaxation_strain.standard_error);
}

TEST(Relaxation, SameSeedSameErrorsOtherSeedOtherErrors)
{
    const std::vector<double> x = strains(40, 2e-3);
    const auto members = ensemble(
        x, 10, 3, [](double s) { return 1 - std::exp(-s / 0.02); }, 0.1);
    const auto error = [&](std::uint64_t seed) {
        return fit_relaxation_of_members(x, members, 1, 30, seed)
            .terms[0]
            .relaxation_strain.standard_error;
    };
    EXPECT_EQ(error(1), error(1));
    EXPECT_NE(error(1), error(2));
}

TEST(Relaxation, WhatDoesNotRelaxIsFiniteAndNotResolved)
{
    const std::vector<double> x = strains(50, 1e-3), error(50, 1.);
    for (int exponentials : {1, 2})
        for (const auto& y : {std::vector<double>(50, 3.), x}) {
            const Relaxation fit = fit_relaxation(x, y, error, exponentials);
            EXPECT_FALSE(fit.resolved);
            for (const RelaxationTerm& term : fit.terms) {
                EXPECT_TRUE(std::isfinite(term.amplitude.standard_error));
                EXPECT_TRUE(std::isfinite(term.relaxation_strain.standard_error));
                EXPECT_GT(term.relaxation_strain.mean, 0);
            }
        }
    // members that agree exactly
    const std::vector<std::vector<double>> equal(
        4, values(x, [](double s) { return 2 - std::exp(-s / 0.01); }));
    const Relaxation fit = fit_relaxation_of_members(x, equal, 1, 10, 1);
    EXPECT_NEAR(fit.terms[0].relaxation_strain.mean, 0.01, 1e-6);
    EXPECT_NEAR(fit.terms[0].relaxation_strain.standard_error, 0, 1e-6);
}

TEST(Relaxation, RefusesWhatIsNoResponse)
{
    const std::vector<double> x = strains(10, 1), y(10, 1.), error(10, 1.);
    EXPECT_THROW(fit_relaxation(x, y, error, 0), Error);
    EXPECT_THROW(fit_relaxation(x, y, error, 3), Error);
    EXPECT_THROW(fit_relaxation(x, y, std::vector<double>(10, 0.), 1), Error);
    EXPECT_THROW(fit_relaxation(x, std::vector<double>(9, 1.), error, 1), Error);
    EXPECT_THROW(fit_relaxation(y, y, error, 1), Error);  // strains that do not rise
    EXPECT_THROW(fit_relaxation(x, std::vector<double>(10, std::nan("")), error, 1), Error);
    EXPECT_THROW(fit_relaxation_of_members(x, {y, y}, 1, 10, 1), Error);
    EXPECT_THROW(fit_relaxation_of_members(x, {y, y, y}, 1, 9, 1), Error);
    EXPECT_THROW(fit_relaxation_of_members(x, {y, y, {1.}}, 1, 10, 1), Error);
}

// The response of the model itself to a step, integrated in strain.
TEST(MemoryKernel, IsThatOfTheModelThatMadeTheResponse)
{
    MemoryKernel truth{.terms = {{{0.7, 0}, {40, 0}}, {{0.5, 0}, {600, 0}}}, .instantaneous = -0.2};
    check(truth);
    const double before = 3, after = 5, dx = 1e-6;
    std::vector<double> x, y;
    double remembered = 0;  // of the change, by quadrature of the density
    for (int k = 0; k <= 100000; ++k) {
        if (k % 250 == 0) {
            x.push_back(k * dx);
            y.push_back(before + (after - before) * (truth.instantaneous + remembered));
        }
        remembered += density(truth, (k + 0.5) * dx) * dx;
    }
    const Relaxation response = fit_relaxation(x, y, std::vector<double>(x.size(), 1e-3), 2);
    const MemoryKernel found = kernel_of(response, before);
    ASSERT_EQ(found.terms.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_NEAR(found.terms[i].weight.mean, truth.terms[i].weight.mean, 1e-4);
        EXPECT_NEAR(found.terms[i].c.mean, truth.terms[i].c.mean, 1e-3 * truth.terms[i].c.mean);
    }
    EXPECT_NEAR(found.instantaneous, -0.2, 1e-4);
}

// A suspension whose contacts carry tau(stress) with memory while the rest of the stress is that of
// a viscosity of 10: the rate jumps by step/10 and comes back to a lower value.
TEST(MemoryKernel, RateResponseKnowsTheHydrodynamicViscosity)
{
    const double stress = 2, before = 0.005, viscosity = stress / before, hydrodynamic = 10;
    const double slope = -0.001, step = 1, c = 50;
    const std::vector<double> x = strains(300, 5e-4);
    const auto rate = [&](double s) {
        return before + step * (slope + (1 / hydrodynamic - slope) * std::exp(-c * s));
    };
    const Relaxation response =
        fit_relaxation(x, values(x, rate), std::vector<double>(x.size(), 1e-4), 1);
    const MemoryKernel kernel = kernel_of_rate(response, before, stress, step);
    const double g = 1 - viscosity * slope;
    EXPECT_NEAR(kernel.terms[0].c.mean, c, 1e-4);
    EXPECT_NEAR(viscosity / (1 - g * kernel.instantaneous), hydrodynamic, 1e-5);
    EXPECT_LT(kernel.instantaneous, 0);
}

TEST(MemoryKernel, RefusesWhatIsNoKernel)
{
    EXPECT_THROW(exponential_kernel({-1, 0}), Error);
    EXPECT_THROW(check({}), Error);
    EXPECT_THROW(check({.terms = {{{0.5, 0}, {1, 0}}}}), Error);
    EXPECT_NO_THROW(check({.terms = {{{0.5, 0}, {1, 0}}}, .instantaneous = 0.5}));
    Relaxation flat;
    flat.plateau = {1, 0};
    EXPECT_THROW(kernel_of(flat, 1), Error);
    EXPECT_THROW(kernel_of_rate(flat, 0, 1, 1), Error);
}

}
