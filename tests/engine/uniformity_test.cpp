// Oracles: p-values of uniform noise are uniform, bands that were put in are found, new data are
// found as often as the power says, translations change nothing.
#include "engine/uniformity.h"

#include "engine/error.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>

namespace sigmaflow {

namespace {

constexpr int slabs = 20, modes = 5;

/// Noise with a standard deviation of 0.1 and correlated neighbours, far from normal: most values
/// are small, some large.
Field skewed_noise(int instants, std::mt19937& random)
{
    std::exponential_distribution<double> exponential;
    Field field;
    for (int t = 0; t < instants; ++t) {
        std::vector<double> w(slabs), f(slabs);
        for (double& value : w) value = std::pow(exponential(random), 2) - 2;
        for (std::size_t k = 0; k < slabs; ++k)
            f[k] = 1 + 0.1 / std::sqrt(20 * 1.25) * (w[k] + 0.5 * w[(k + 1) % slabs]);
        field.push_back(std::move(f));
    }
    return field;
}

/// White normal noise; each value remembers a share of the one at the instant before.
Field normal_noise(int instants, std::mt19937& random, double memory = 0)
{
    std::normal_distribution<double> normal;
    std::vector<double> value(slabs);
    for (double& v : value) v = normal(random);
    Field field;
    for (int t = 0; t < instants; ++t) {
        std::vector<double> f(slabs);
        for (std::size_t k = 0; k < slabs; ++k) {
            f[k] = 1 + 0.1 * value[k];
            value[k] = memory * value[k] + std::sqrt(1 - memory * memory) * normal(random);
        }
        field.push_back(std::move(f));
    }
    return field;
}

/// Adds contrast times (1 - width) in [first, first + width slabs) and the rest outside.
void add_band(std::vector<double>& instant, double contrast, std::size_t first, std::size_t width)
{
    const double share = static_cast<double>(width) / slabs;
    for (std::size_t k = 0; k < slabs; ++k) {
        const bool inside = (k + slabs - first) % slabs < width;
        instant[k] += contrast * (inside ? 1 - share : -share);
    }
}

void add_steady(Field& field, double contrast, std::size_t first = 4, std::size_t width = 10)
{
    for (auto& instant : field) add_band(instant, contrast, first, width);
}

void add_moving(Field& field, double contrast, std::mt19937& random)
{
    for (auto& instant : field) add_band(instant, contrast, random() % slabs, 10);
}

UniformitySettings quick()
{
    return {.shifts = 199, .trials = 1};
}

/// Each share of the p-values must be what it says, within four of its errors.
void expect_uniform(std::vector<double> p_values, const char* name)
{
    const auto sets = static_cast<double>(p_values.size());
    for (const double level : {0.05, 0.1, 0.25, 0.5, 0.75, 0.9}) {
        const auto below = std::count_if(p_values.begin(), p_values.end(),
                                         [&](double p) { return p <= level + 1e-12; });
        EXPECT_NEAR(static_cast<double>(below) / sets, level,
                    4 * std::sqrt(level * (1 - level) / sets))
            << name << " at " << level;
    }
}

std::vector<double> rolled(const std::vector<double>& profile, std::size_t by)
{
    std::vector<double> result(profile.size());
    for (std::size_t k = 0; k < profile.size(); ++k) result[(k + by) % profile.size()] = profile[k];
    return result;
}

}

TEST(BandSearch, PValuesOfUniformNoiseAreUniform)
{
    std::mt19937 random(1);
    const BandShapes shapes(modes, slabs);
    std::vector<double> chi2, ratio, order, first_mode;
    for (unsigned set = 0; set < 600; ++set) {
        const Field field = skewed_noise(6, random);
        const auto found = search_steady_bands(mode_amplitudes(field, modes), shapes,
                                               random_shifts(99, 6, slabs, {set, 0}));
        chi2.push_back(found.chi2_p_value);
        ratio.push_back(found.p_value);
        first_mode.push_back(found.mode_p_value[0]);
        if (set < 200) {
            UniformitySettings settings = quick();
            settings.seed = set;
            order.push_back(order_parameter(field, settings).p_value);
        }
    }
    expect_uniform(chi2, "chi2");
    expect_uniform(ratio, "likelihood ratio");
    expect_uniform(first_mode, "mode 1");
    expect_uniform(order, "order parameter");
}

TEST(BandSearch, ChiSquaredOfManyInstantsIsThatOfTwiceAsManyDegreesAsModes)
{
    std::mt19937 random(2);
    const BandShapes shapes(modes, slabs);
    const auto shifts = random_shifts(1, 60, slabs, {});
    std::vector<double> values;
    for (int set = 0; set < 500; ++set)
        values.push_back(
            search_steady_bands(mode_amplitudes(normal_noise(60, random), modes), shapes, shifts)
                .chi2);
    std::sort(values.begin(), values.end());
    EXPECT_NEAR(std::accumulate(values.begin(), values.end(), 0.0) / 500, 10, 0.8);
    EXPECT_NEAR(values[250], 9.342, 0.8);  // tables, chi^2 with 10 degrees
    EXPECT_NEAR(values[475], 18.307, 1.8);
}

TEST(BandSearch, ExcessOfModeOneIsUniformForEveryPowerLaw)
{
    const auto expected = excess_without_bands(modes, 9, 1999, {3, 0});
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    for (const double exponent : {0.0, -2.0, 1.5}) {
        std::vector<double> p_values;
        for (int set = 0; set < 600; ++set) {
            Amplitudes amplitudes(modes, 10);
            for (int m = 0; m < modes; ++m)
                for (int t = 0; t < 10; ++t)
                    amplitudes(m, t) = std::pow(m + 1.0, exponent / 2) *
                                       std::complex<double>(normal(random), normal(random));
            p_values.push_back(upper_p_value(expected, moving_band_excess(amplitudes)));
        }
        expect_uniform(p_values, "excess");
    }
}

// local rates white but for the drag, which takes out what is longer than 1/20 of the box, and for
// particles of 1/20 of it
TEST(BandSearch, ExcessHasFewerFalseAlarmsWithDragAndParticlesOfFiniteSize)
{
    const auto expected = excess_without_bands(modes, 19, 1999, {4, 0});
    std::mt19937 random(4);
    std::normal_distribution<double> normal;
    int alarms = 0;
    constexpr int sets = 1000;
    for (int set = 0; set < sets; ++set) {
        Amplitudes amplitudes(modes, 20);
        for (int m = 0; m < modes; ++m) {
            const double k = 2 * M_PI * (m + 1) / 20;
            const double amplitude = k * k / (k * k + 0.1) * std::exp(-k * k / 2);
            for (int t = 0; t < 20; ++t)
                amplitudes(m, t) = amplitude * std::complex<double>(normal(random), normal(random));
        }
        alarms += upper_p_value(expected, moving_band_excess(amplitudes)) <= 0.05;
    }
    EXPECT_LE(alarms, 0.05 * sets);
}

TEST(Uniformity, FalseAlarmsAreNotMoreThanTheLevel)
{
    std::mt19937 random(5);
    int alarms = 0;
    constexpr int sets = 300;
    for (unsigned set = 0; set < sets; ++set) {
        UniformitySettings settings = quick();
        settings.seed = set;
        alarms += test_uniformity(normal_noise(10, random), settings).verdict == BandVerdict::bands;
    }
    EXPECT_LE(alarms, 0.05 * sets + 3 * std::sqrt(0.05 * 0.95 * sets));
    EXPECT_GE(alarms, 0.05 * sets - 3 * std::sqrt(0.05 * 0.95 * sets));
}

TEST(Uniformity, FindsASteadyBandWithItsContrastWidthAndPlace)
{
    std::mt19937 random(6);
    Field field = normal_noise(40, random);
    add_steady(field, 0.3, 6, 5);
    const UniformityTest test = test_uniformity(field, quick());
    EXPECT_EQ(test.verdict, BandVerdict::bands);
    EXPECT_TRUE(test.has_steady);
    EXPECT_FALSE(test.has_moving);
    EXPECT_EQ(test.blocks, 40);
    EXPECT_NEAR(test.steady.contrast, 0.3, 0.05);
    EXPECT_NEAR(test.steady.fraction, 0.25, 0.07);
    EXPECT_NEAR(test.steady.place, 8.5 / slabs, 0.05);
    EXPECT_GT(test.steady.likelihood_ratio, 0.7 * test.steady.chi2);
    // a low band is a high one with the rest of the box
    for (auto& instant : field)
        for (double& value : instant) value = -value;
    const UniformityTest low = test_uniformity(field, quick());
    EXPECT_NEAR(low.steady.contrast, test.steady.contrast, 1e-12);
    EXPECT_NEAR(low.steady.fraction, 1 - test.steady.fraction, 1e-12);
    EXPECT_NEAR(low.steady.place, test.steady.place + 0.5, 1e-12);
}

TEST(Uniformity, AmplitudesAreThoseOfACosine)
{
    std::mt19937 random(7);
    Field field = normal_noise(50, random);
    for (auto& instant : field)
        for (std::size_t k = 0; k < slabs; ++k)
            instant[k] +=
                0.4 * std::cos(2 * M_PI * 2 * ((static_cast<double>(k) + 0.5) / slabs - 0.3));
    const UniformityTest test = test_uniformity(field, quick());
    // noise of standard deviation 0.1: <|A|^2> = 0.01/slabs
    EXPECT_NEAR(test.modes[1].amplitude, 0.2, 4 * test.modes[1].standard_error);
    EXPECT_NEAR(test.modes[1].phase, 0.3, 0.02);
    EXPECT_NEAR(test.modes[1].fluctuation, 0.01 / slabs, 0.5 * 0.01 / slabs);
    EXPECT_NEAR(test.modes[1].standard_error, std::sqrt(0.01 / slabs / 50), 0.0008);
    EXPECT_LE(test.modes[1].p_value, 0.01);
    EXPECT_GT(test.modes[3].p_value, 0.01);
}

TEST(Uniformity, FindsMovingBandsByTheFluctuationsOfModeOne)
{
    std::mt19937 random(8);
    Field field = normal_noise(40, random);
    add_moving(field, 0.4, random);
    const UniformityTest test = test_uniformity(field, quick());
    EXPECT_EQ(test.verdict, BandVerdict::bands);
    EXPECT_TRUE(test.has_moving);
    EXPECT_FALSE(test.has_steady);
    EXPECT_GT(test.moving.excess, 5);
}

// The share of new data with bands of the smallest contrast that are found, and of weaker ones.
TEST(Uniformity, BandsOfTheSmallestContrastAreFoundAsOftenAsPromised)
{
    std::mt19937 random(9);
    UniformitySettings settings{.shifts = 199, .trials = 100};
    constexpr int instants = 12;
    double steady = 0, moving = 0;
    for (unsigned set = 0; set < 6; ++set) {
        settings.seed = set;
        const UniformityTest test = test_uniformity(normal_noise(instants, random), settings);
        ASSERT_TRUE(test.smallest_steady && test.smallest_moving);
        steady += *test.smallest_steady / 6;
        moving += *test.smallest_moving / 6;
    }
    EXPECT_LT(steady, moving);
    const BandShapes shapes(modes, slabs);
    const auto expected = excess_without_bands(modes, instants - 1, 1999, {3, 0});
    constexpr int sets = 300;
    int found_steady = 0, found_half = 0, found_moving = 0;
    for (unsigned set = 0; set < sets; ++set) {
        const auto shifts = random_shifts(199, instants, slabs, {set, 9});
        const Field noise = normal_noise(instants, random);
        Field banded = noise, half = noise, travelling = noise;
        add_steady(banded, steady);
        add_steady(half, steady / 2);
        add_moving(travelling, moving, random);
        const auto finds = [&](const Field& field) {
            return steady_band_p_value(mode_amplitudes(field, modes), shapes, shifts) <= 0.025;
        };
        found_steady += finds(banded);
        found_half += finds(half);
        found_moving +=
            upper_p_value(expected, moving_band_excess(mode_amplitudes(travelling, modes))) <=
            0.025;
    }
    EXPECT_NEAR(found_steady, 0.95 * sets, 0.05 * sets);
    EXPECT_LT(found_half, 0.7 * sets);
    EXPECT_NEAR(found_moving, 0.95 * sets, 0.06 * sets);
}

TEST(Uniformity, TranslationByWholeSlabsChangesNothing)
{
    std::mt19937 random(10);
    Field field = skewed_noise(8, random), moved;
    add_steady(field, 0.1);
    for (const auto& instant : field) moved.push_back(rolled(instant, 13));
    const UniformityTest one = test_uniformity(field, quick()),
                         two = test_uniformity(moved, quick());
    EXPECT_EQ(one.verdict, two.verdict);
    EXPECT_EQ(one.steady.p_value, two.steady.p_value);
    EXPECT_EQ(one.steady.chi2_p_value, two.steady.chi2_p_value);
    EXPECT_EQ(one.steady.mode_p_value, two.steady.mode_p_value);
    EXPECT_EQ(one.moving.p_value, two.moving.p_value);
    EXPECT_EQ(one.order.p_value, two.order.p_value);
    EXPECT_NEAR(one.steady.chi2, two.steady.chi2, 1e-9);
    EXPECT_NEAR(one.steady.likelihood_ratio, two.steady.likelihood_ratio, 1e-9);
    EXPECT_NEAR(one.order.lower, two.order.lower, 1e-12);
    EXPECT_NEAR(one.order.value, two.order.value, 1e-12);
    const double moved_by = two.steady.place - one.steady.place;
    EXPECT_NEAR(moved_by - std::floor(moved_by), 13.0 / slabs, 1e-9);
}

// With a memory of 20 instants, 100 of them are few; a band at rest in white noise costs none.
TEST(Uniformity, SlowNoiseIsNoBandAndABandIsNoSlowNoise)
{
    std::mt19937 random(11);
    int alarms = 0, blocks = 0;
    constexpr int sets = 100;
    for (unsigned set = 0; set < sets; ++set) {
        UniformitySettings settings = quick();
        settings.seed = set;
        const UniformityTest test = test_uniformity(normal_noise(200, random, 0.9), settings);
        blocks += test.blocks;
        alarms += test.has_steady;
    }
    EXPECT_LE(alarms, 0.12 * sets);
    EXPECT_LT(blocks, 10 * sets);
    EXPECT_GT(blocks, 3 * sets);
    Field field = normal_noise(30, random);
    add_steady(field, 1);
    EXPECT_EQ(test_uniformity(field, quick()).blocks, 30);
}

TEST(OrderParameter, IntervalHoldsTheContrastOfTwoHalves)
{
    std::mt19937 random(12);
    for (const double contrast : {0.0, 0.2}) {
        int covered = 0, excluded_zero = 0;
        constexpr int sets = 200;
        double from_noise = 0;
        for (unsigned set = 0; set < sets; ++set) {
            Field field = normal_noise(20, random);
            add_steady(field, contrast);
            UniformitySettings settings = quick();
            settings.seed = set;
            const OrderParameter order = order_parameter(field, settings);
            covered += order.lower <= contrast && contrast <= order.upper;
            excluded_zero += order.lower > 0;
            from_noise += order.from_noise / sets;
        }
        EXPECT_GE(covered, 0.88 * sets) << contrast;
        if (contrast == 0) {
            EXPECT_LE(excluded_zero, 0.05 * sets);
            // two halves of 10 slabs, 20 instants: each difference has the error 0.1 sqrt(4/400)
            EXPECT_GT(from_noise, 0.01);
            EXPECT_LT(from_noise, 0.03);
        } else {
            EXPECT_GE(excluded_zero, 0.99 * sets);
        }
    }
    Field exact = normal_noise(4, random);
    for (auto& instant : exact) std::fill(instant.begin(), instant.end(), 1.0);
    add_steady(exact, 0.3);
    EXPECT_NEAR(order_parameter(exact, quick()).value, 0.3, 1e-12);
}

TEST(Uniformity, FewInstantsOrNoFluctuationsDecideNothing)
{
    std::mt19937 random(13);
    for (int instants : {1, 2, 3}) {
        const UniformityTest test = test_uniformity(normal_noise(instants, random), quick());
        EXPECT_EQ(test.verdict, BandVerdict::undecided);
        EXPECT_EQ(test.instants, instants);
    }
    const UniformityTest still =
        test_uniformity(Field(9, std::vector<double>(slabs, 1.0)), quick());
    EXPECT_EQ(still.verdict, BandVerdict::undecided);
    EXPECT_FALSE(still.has_steady || still.has_moving);
    Field noisy = normal_noise(5, random);  // bands of 0.01 in noise of 0.1: not to be seen
    UniformitySettings weak = quick();
    weak.largest_contrast = 0.01;
    weak.trials = 50;
    const UniformityTest hidden = test_uniformity(noisy, weak);
    EXPECT_FALSE(hidden.smallest_steady);
    EXPECT_EQ(hidden.verdict,
              hidden.has_steady || hidden.has_moving ? BandVerdict::bands : BandVerdict::undecided);
}

TEST(Uniformity, NamesImpossibleInput)
{
    const Field good(6, std::vector<double>(slabs, 1.0));
    Field uneven = good, infinite = good;
    uneven[2].pop_back();
    infinite[1][3] = INFINITY;
    const auto refused = [](const Field& field, const UniformitySettings& settings) {
        EXPECT_THROW(test_uniformity(field, settings), Error);
    };
    refused({}, {});
    refused(uneven, {});
    refused(infinite, {});
    refused(Field(6, std::vector<double>(10, 1.0)), {});  // 5 modes need 11 slabs
    refused(good, {.level = 0});
    refused(good, {.power = 1});
    refused(good, {.modes = 2});
    refused(good, {.largest_contrast = 0});
    refused(good, {.shifts = 10});
    refused(good, {.trials = 0});
}

}
