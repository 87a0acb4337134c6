#include "engine/error.h"
#include "engine/wyart_cates_uncertainty.h"
#include "tests/support/random_state.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

namespace sigmaflow {

namespace {

using Parameter = WyartCatesParameter;
using Points = std::vector<WyartCatesPoint>;

constexpr WyartCatesVariant exponent_2{}, exponent_free{std::nullopt, 1},
    all_free{std::nullopt, std::nullopt};

void set_bounds(Points& points)
{
    for (WyartCatesPoint& p : points)
        if (p.jammed) p.viscosity = lower_bound(points);
}

/// tests/data/ness_viscosity.csv up to a volume fraction. The two viscosities above 5e4 are taken
/// as jammed: the published fits left them out.
Points ness(double highest_fraction, bool with_jammed)
{
    std::ifstream file(SIGMAFLOW_TEST_DATA "/ness_viscosity.csv");
    std::string line, cell;
    while (std::getline(file, line) && line.starts_with('#')) {
    }
    std::vector<double> stresses;
    std::istringstream head(line);
    std::getline(head, cell, ',');
    while (std::getline(head, cell, ',')) stresses.push_back(std::stod(cell));
    Points points;
    while (std::getline(file, line)) {
        std::istringstream row(line);
        std::getline(row, cell, ',');
        WyartCatesPoint p{.volume_fraction = std::stod(cell)};
        for (double stress : stresses) {
            std::getline(row, cell, ',');
            p.stress = stress;
            p.jammed = cell == "jam" || std::stod(cell) > 5e4;
            p.viscosity = p.jammed ? 0 : std::stod(cell);
            if (p.volume_fraction <= highest_fraction && (with_jammed || !p.jammed))
                points.push_back(p);
        }
    }
    set_bounds(points);
    return points;
}

constexpr WyartCates truth{.onset_stress = 1.45,
                           .frictional_fraction = 0.585,
                           .frictionless_fraction = 0.66,
                           .amplitude = 1.2,
                           .exponent = 2.3};

/// Of a model, with normal errors of ln viscosity; what is above 1e5 is jammed.
Points synthetic(const WyartCates& m, double error, unsigned seed,
                 const std::vector<double>& fractions = {0.5, 0.54, 0.56, 0.58, 0.6},
                 const std::vector<double>& stresses = {0.2, 0.5, 1, 2, 5, 20})
{
    support::Random random(seed);
    Points points;
    for (double phi : fractions) {
        for (double stress : stresses) {
            double normal = -6;  // the sum of twelve uniform numbers
            for (int k = 0; k < 12; ++k) normal += random.uniform(0, 1);
            const double exact = viscosity(m, phi, stress);
            if (exact < 1e5)
                points.push_back({phi, stress, exact * std::exp(error * normal), error, false});
            else
                points.push_back({phi, stress, 0, 0, true});
        }
    }
    set_bounds(points);
    return points;
}

void expect_model(const WyartCates& m, double onset, double frictionless, double frictional,
                  double amplitude, double exponent)
{
    EXPECT_NEAR(m.onset_stress, onset, 6e-5);  // half of the last digit printed
    EXPECT_NEAR(m.frictionless_fraction, frictionless, 6e-5);
    EXPECT_NEAR(m.frictional_fraction, frictional, 6e-5);
    EXPECT_NEAR(m.amplitude, amplitude, 6e-4);
    EXPECT_NEAR(m.exponent, exponent, 6e-3);
}

}

// Fits made before with an independent program.
TEST(WyartCatesFit, IsThatOfAnIndependentProgram)
{
    struct Known {
        double highest_fraction;
        WyartCatesVariant variant;
        double onset, frictionless, frictional, amplitude, exponent, rms;
    };
    for (const Known& k :
         {Known{0.585, exponent_2, 0.0378, 0.7284, 0.5877, 1.375, 2, 0.115},
          Known{0.585, exponent_free, 0.0469, 0.7132, 0.5944, 0.593, 2.49, 0.055},
          Known{0.635, exponent_2, 0.0616, 0.6708, 0.5887, 1.128, 2, 0.404},
          Known{0.635, exponent_free, 0.0528, 0.6885, 0.6014, 0.179, 3.11, 0.245}}) {
        const WyartCatesFit fit = fit_wyart_cates(ness(k.highest_fraction, false), k.variant);
        expect_model(fit.model, k.onset, k.frictionless, k.frictional, k.amplitude, k.exponent);
        EXPECT_NEAR(fit.rms, k.rms, 6e-4);
        EXPECT_NEAR(fit.scatter, fit.rms, 1e-5);  // nothing else: no errors, nothing jammed
        EXPECT_TRUE(fit.converged);
    }
    // with a free sharpness: 0.92 to 1
    const WyartCatesFit free = fit_wyart_cates(ness(0.635, false), all_free);
    EXPECT_NEAR(free.model.sharpness, 0.92, 0.006);
    EXPECT_NEAR(fit_wyart_cates(ness(0.585, false), all_free).model.sharpness, 1, 0.006);
}

TEST(WyartCatesFit, FrictionalFractionOfTheTableIsRobustTheFrictionlessOneIsNot)
{
    std::vector<double> frictional, frictionless;
    for (double highest : {0.585, 0.605, 0.635})
        for (const WyartCatesVariant& variant : {exponent_2, exponent_free}) {
            const WyartCates m = fit_wyart_cates(ness(highest, true), variant).model;
            frictional.push_back(m.frictional_fraction);
            frictionless.push_back(m.frictionless_fraction);
        }
    const auto [lowest_mu, highest_mu] = std::minmax_element(frictional.begin(), frictional.end());
    const auto [lowest_0, highest_0] =
        std::minmax_element(frictionless.begin(), frictionless.end());
    EXPECT_GT(*lowest_mu, 0.587);
    EXPECT_LT(*highest_mu, 0.603);
    EXPECT_GT(*highest_0 - *lowest_0, 0.05);
}

TEST(WyartCatesFit, JammedCellsOfTheTableAskForAnEarlierOnset)
{
    const Points without = ness(0.635, false), with = ness(0.635, true);
    const WyartCatesFit left_out = fit_wyart_cates(without), censored = fit_wyart_cates(with);
    EXPECT_EQ(censored.flowing, left_out.flowing);
    EXPECT_EQ(censored.jammed, 30);
    EXPECT_LT(censored.model.onset_stress, left_out.model.onset_stress);
    EXPECT_LT(censored.model.frictionless_fraction, left_out.model.frictionless_fraction);
    EXPECT_NEAR(censored.model.frictional_fraction, left_out.model.frictional_fraction, 0.002);
    EXPECT_GT(censored.rms, left_out.rms);  // that one has the smallest there is
    const auto too_fluid = [&](const WyartCates& m) {
        return std::count_if(with.begin(), with.end(), [&](const WyartCatesPoint& p) {
            return p.jammed && viscosity(m, p.volume_fraction, p.stress) < p.viscosity;
        });
    };
    EXPECT_LT(too_fluid(censored.model), too_fluid(left_out.model));
}

TEST(WyartCatesFit, FindsTheModelThatMadeTheData)
{
    for (const WyartCatesVariant& variant : {exponent_free, all_free}) {
        const WyartCatesFit fit = fit_wyart_cates(synthetic(truth, 0, 1), variant);
        EXPECT_TRUE(fit.converged);
        EXPECT_GT(fit.jammed, 0);
        for (Parameter p : wyart_cates_parameters)
            EXPECT_NEAR(value_of(fit.model, p) / value_of(truth, p), 1, 1e-4) << parameter_name(p);
    }
    const WyartCatesFit noisy = fit_wyart_cates(synthetic(truth, 0.03, 5), exponent_free);
    EXPECT_NEAR(noisy.model.frictional_fraction, truth.frictional_fraction, 0.005);
    EXPECT_NEAR(noisy.model.frictionless_fraction, truth.frictionless_fraction, 0.008);
    EXPECT_NEAR(noisy.model.onset_stress, truth.onset_stress, 0.15);
    EXPECT_LT(noisy.scatter, 0.02);  // the errors given explain all
}

TEST(WyartCatesFit, ScatterIsWhatTheErrorsDoNotExplain)
{
    Points points = synthetic(truth, 0.1, 8);
    for (WyartCatesPoint& p : points) p.relative_error = 0;
    const WyartCatesFit without = fit_wyart_cates(points, exponent_free);
    EXPECT_NEAR(without.scatter, 0.1, 0.03);
    for (WyartCatesPoint& p : points) p.relative_error = 0.06;
    const WyartCatesFit with = fit_wyart_cates(points, exponent_free);
    EXPECT_NEAR(std::hypot(with.scatter, 0.06), without.scatter, 1e-3);
}

TEST(WyartCatesFit, TheBetterModelHasTheLowerAkaikeNumber)
{
    const auto akaike = [](const Points& points, const WyartCatesVariant& variant) {
        return fit_wyart_cates(points, variant).akaike;
    };
    const Points steep = synthetic({.exponent = 3}, 0.03, 2);
    EXPECT_LT(akaike(steep, exponent_free), akaike(steep, exponent_2) - 10);
    const Points square = synthetic({.exponent = 2}, 0.03, 2);
    EXPECT_LT(akaike(square, exponent_2), akaike(square, all_free));
    EXPECT_GT(akaike(square, exponent_2), akaike(square, all_free) - 4.01);  // two parameters
}

TEST(WyartCatesFit, JammedPointPullsTheJammingFractionDown)
{
    Points points = synthetic(truth, 0.03, 3, {0.48, 0.5, 0.52, 0.54});
    const double highest = lower_bound(points);
    const WyartCatesFit before = fit_wyart_cates(points);
    // jams in truth, and in the model: tells nothing new
    points.push_back({0.62, 20, 10 * highest, 0, true});
    const WyartCatesFit same = fit_wyart_cates(points);
    EXPECT_NEAR(same.model.frictional_fraction, before.model.frictional_fraction, 1e-6);
    EXPECT_NEAR(same.deviance, before.deviance, 1e-6);
    // flows in truth: phi_mu falls, the more the higher the bound
    points.back() = {0.55, 20, 5 * highest, 0, true};
    const WyartCatesFit lower = fit_wyart_cates(points);
    EXPECT_LT(lower.model.frictional_fraction, before.model.frictional_fraction - 1e-4);
    points.back().viscosity = 20 * highest;
    const WyartCatesFit lowest = fit_wyart_cates(points);
    EXPECT_LT(lowest.model.frictional_fraction, lower.model.frictional_fraction - 1e-4);
    EXPECT_GT(lowest.deviance, lower.deviance);
}

TEST(WyartCatesFit, FlowingPointsStayBelowJamming)
{
    Points points = synthetic(truth, 0.3, 4);
    points.push_back({0.63, 20, 50, 0.01, false});  // flows like nothing else
    for (const WyartCatesVariant& variant : {exponent_2, all_free}) {
        const WyartCates m = fit_wyart_cates(points, variant).model;
        for (const WyartCatesPoint& p : points)
            EXPECT_TRUE(p.jammed || std::isfinite(viscosity(m, p.volume_fraction, p.stress)));
        EXPECT_LE(m.frictional_fraction, m.frictionless_fraction);
    }
}

// 95 % intervals of 40 sets of data: 38 are expected to hold the truth.
TEST(WyartCatesUncertainty, BootstrapIntervalsHoldTheTruthAsOftenAsTheyClaim)
{
    WyartCates m = truth;
    m.exponent = 2;
    constexpr int sets = 40;
    int frictional = 0, frictionless = 0, onset = 0;
    for (int set = 0; set < sets; ++set) {
        const Points points =
            synthetic(m, 0.05, 100 + set, {0.5, 0.54, 0.57, 0.6}, {0.2, 1, 2, 5, 20});
        const WyartCatesFit fit = fit_wyart_cates(points);
        const auto drawn = bootstrap_wyart_cates(points, exponent_2, fit, 40, 17);
        const auto holds = [&](Parameter p) {
            std::vector<double> values;
            for (const WyartCates& one : drawn) values.push_back(value_of(one, p));
            const Interval i = percentile_interval(values, 0.95);
            return i.lower <= value_of(m, p) && value_of(m, p) <= i.upper;
        };
        frictional += holds(Parameter::frictional_fraction);
        frictionless += holds(Parameter::frictionless_fraction);
        onset += holds(Parameter::onset_stress);
    }
    for (int held : {frictional, frictionless, onset}) {
        EXPECT_GE(held, 33);  // fewer: 1 %; intervals of one standard error would hold 27
        EXPECT_LE(held, sets);
    }
    EXPECT_LT(frictional + frictionless + onset, 3 * sets);  // not too long either
}

TEST(WyartCatesUncertainty, BootstrapDependsOnTheSeedAlone)
{
    const Points points = synthetic(truth, 0.05, 6);
    const WyartCatesFit fit = fit_wyart_cates(points);
    const auto first = [&](int seed) {
        return bootstrap_wyart_cates(points, exponent_2, fit, 2, seed)[0].frictional_fraction;
    };
    EXPECT_EQ(first(1), first(1));
    EXPECT_NE(first(1), first(2));
}

TEST(WyartCatesUncertainty, ProfileEndsWhereTheDevianceHasRisenEnough)
{
    const Points points = synthetic(truth, 0.05, 7);
    const WyartCatesFit fit = fit_wyart_cates(points, exponent_free);
    for (Parameter p :
         {Parameter::frictional_fraction, Parameter::frictionless_fraction, Parameter::exponent}) {
        const Interval i = profile_interval(points, exponent_free, fit, p, 0.95);
        EXPECT_FALSE(i.open_below || i.open_above);
        EXPECT_LT(i.lower, value_of(fit.model, p));
        EXPECT_GT(i.upper, value_of(fit.model, p));
        for (double end : {i.lower, i.upper}) {
            const WyartCatesFit held =
                refit_wyart_cates(points, exponent_free, fit, HeldParameter{p, end});
            EXPECT_NEAR(value_of(held.model, p) / end, 1, 1e-5);
            EXPECT_NEAR(held.deviance - fit.deviance, 3.84, 0.1) << parameter_name(p);
        }
    }
    EXPECT_THROW(profile_interval(points, exponent_2, fit, Parameter::exponent, 0.95), Error);
}

TEST(WyartCatesUncertainty, WhatTheDataDoNotShowIsOpen)
{
    const auto profile = [](const Points& points, Parameter p) {
        constexpr WyartCatesVariant known{truth.exponent, 1};
        return profile_interval(points, known, fit_wyart_cates(points, known), p, 0.95);
    };
    // the onset is seen, but not what comes above: phi_mu may be anything below phi_0
    const Points low =
        synthetic(truth, 0.02, 9, {0.5, 0.58, 0.62, 0.64}, {0.02, 0.05, 0.1, 0.2, 0.4});
    EXPECT_TRUE(profile(low, Parameter::frictional_fraction).open_below);
    EXPECT_FALSE(profile(low, Parameter::frictionless_fraction).open_above);
    // friction everywhere: phi_0 may be anything above phi_mu
    const Points high = synthetic(truth, 0.03, 9, {0.5, 0.54, 0.56}, {100, 200, 500, 1000});
    EXPECT_TRUE(profile(high, Parameter::frictionless_fraction).open_above);
    EXPECT_FALSE(profile(high, Parameter::frictional_fraction).open_below);
}

TEST(WyartCatesUncertainty, PercentilesAreThoseOfAKnownList)
{
    std::vector<double> values;
    for (int k = 0; k <= 100; ++k) values.push_back((37 * k) % 101);
    const Interval i = percentile_interval(values, 0.9);
    EXPECT_NEAR(i.lower, 5, 1e-9);
    EXPECT_NEAR(i.upper, 95, 1e-9);
    EXPECT_EQ(percentile_interval({3}, 0.5).upper, 3);
}

TEST(WyartCatesUncertainty, RangesLeaveOutTheEnds)
{
    const Points points = synthetic(truth, 0, 1);
    const auto ranges = fit_ranges(points);
    ASSERT_EQ(ranges.size(), 5u);
    std::vector<std::size_t> sizes;
    for (const FitRange& range : ranges) sizes.push_back(points_in(range, points).size());
    EXPECT_EQ(sizes, (std::vector<std::size_t>{30, 24, 18, 25, 25}));
    EXPECT_EQ(ranges[2].highest_fraction, 0.56);
    EXPECT_EQ(ranges[3].lowest_stress, 0.5);
    EXPECT_EQ(ranges[4].highest_stress, 5);
    EXPECT_TRUE(fit_ranges({}).empty());
    EXPECT_EQ(fit_ranges(Points{{0.5, 1, 10, 0, false}}).size(), 1u);
}

TEST(WyartCatesFit, RefusesWhatCannotBeFitted)
{
    const Points good = synthetic(truth, 0.03, 1);
    const auto refused = [](const Points& points, const WyartCatesVariant& variant,
                            const std::string& text) {
        try {
            fit_wyart_cates(points, variant);
            ADD_FAILURE() << "accepted: " << text;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::input);
            EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
        }
    };
    refused({}, exponent_2, "at least 5 flowing points, there are 0");
    refused({good.begin(), good.begin() + 6}, exponent_2, "two volume fractions");
    refused(synthetic(truth, 0, 1, {0.5, 0.51, 0.52, 0.53, 0.54, 0.55}, {1}), exponent_2,
            "two stresses");
    refused(synthetic(truth, 0, 1, {0.5, 0.55}, {1, 2, 5}), all_free, "at least 7");
    refused(good, {20, 1}, "the exponent must lie between");
    refused(good, {2, 0.01}, "the sharpness must lie between");
    const auto spoilt = [&](double WyartCatesPoint::*member, double value) {
        Points points = good;
        points[3].*member = value;
        return points;
    };
    refused(spoilt(&WyartCatesPoint::volume_fraction, 1), exponent_2, "a volume fraction");
    refused(spoilt(&WyartCatesPoint::stress, 0), exponent_2, "a stress");
    refused(spoilt(&WyartCatesPoint::viscosity, -1), exponent_2, "a viscosity");
    refused(spoilt(&WyartCatesPoint::relative_error, NAN), exponent_2, "a relative error");
}

}
