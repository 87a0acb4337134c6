// Oracles: flows whose profile is known, independence of the choice of periodic images,
// conservation.
#include "engine/velocity_profile.h"

#include "engine/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace sigmaflow {
namespace {

State random_state(int particles, unsigned seed)
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform;
    State state;
    state.box.length = {12, 16, 9};
    state.box.offset = 3.3;
    for (int i = 0; i < particles; ++i) {
        const Vec3 place(uniform(random), uniform(random), uniform(random));
        state.position.push_back(place.cwiseProduct(state.box.length));
        state.radius.push_back(i % 2 == 0 ? 1.0 : 1.4);
    }
    return state;
}

std::vector<Vec3> affine_flow(const State& state, double shear_rate)
{
    std::vector<Vec3> velocity;
    for (const Vec3& place : state.position) velocity.emplace_back(shear_rate * place.y(), 0, 0);
    return velocity;
}

/// Affine flow plus random velocities.
std::vector<Vec3> noisy_flow(const State& state, double shear_rate, unsigned seed)
{
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::vector<Vec3> velocity = affine_flow(state, shear_rate);
    for (Vec3& u : velocity) u += Vec3(normal(random), normal(random), normal(random));
    return velocity;
}

double sphere_volume(double radius)
{
    return 4 * std::numbers::pi / 3 * radius * radius * radius;
}

TEST(VelocityProfile, OfAnAffineFlowIsExactlyLinear)
{
    const State state = random_state(300, 1);
    const VelocityProfile profile = velocity_profile(state, affine_flow(state, 0.37), 0.37, 20);
    ASSERT_EQ(profile.u.size(), 20u);
    for (std::size_t k = 0; k < 20; ++k) {
        EXPECT_DOUBLE_EQ(profile.y[k], (static_cast<double>(k) + 0.5) / 20);
        EXPECT_EQ(profile.u[k], profile.y[k]);
    }
}

TEST(VelocityProfile, DoesNotDependOnTheChoiceOfPeriodicImages)
{
    const double shear_rate = -1.7;
    const State state = random_state(200, 2);
    const std::vector<Vec3> velocity = noisy_flow(state, shear_rate, 3);
    State moved = state;
    std::vector<Vec3> moved_velocity = velocity;
    for (std::size_t i = 0; i < moved.position.size(); ++i) {
        const int rows = static_cast<int>(i % 5) - 2;
        moved.position[i] += rows * Vec3(state.box.offset, state.box.length.y(), 0);
        moved_velocity[i].x() += rows * shear_rate * state.box.length.y();
    }
    const VelocityProfile one = velocity_profile(state, velocity, shear_rate, 17);
    const VelocityProfile two = velocity_profile(moved, moved_velocity, shear_rate, 17);
    EXPECT_EQ(one.count, two.count);
    for (std::size_t k = 0; k < one.u.size(); ++k) {
        EXPECT_NEAR(one.u[k], two.u[k], 1e-12);
        EXPECT_NEAR(one.volume_fraction[k], two.volume_fraction[k], 1e-12);
    }
}

TEST(VelocityProfile, ConservesVolumeNumberAndMeanNonaffineVelocity)
{
    const double shear_rate = 0.8;
    const State state = random_state(150, 4);
    const std::vector<Vec3> velocity = noisy_flow(state, shear_rate, 5);
    double solid = 0, flux = 0;
    for (std::size_t i = 0; i < state.radius.size(); ++i) {
        const double volume = sphere_volume(state.radius[i]);
        solid += volume;
        flux += volume * (velocity[i].x() - shear_rate * state.position[i].y());
    }
    for (const int bins : {1, 7, 20, 400}) {
        SCOPED_TRACE(bins);
        const VelocityProfile profile = velocity_profile(state, velocity, shear_rate, bins);
        const double slab_volume = state.box.volume() / bins;
        double binned_solid = 0, binned_flux = 0;
        int particles = 0;
        for (std::size_t k = 0; k < profile.u.size(); ++k) {
            const double volume = profile.volume_fraction[k] * slab_volume;
            binned_solid += volume;
            binned_flux +=
                volume * (profile.u[k] - profile.y[k]) * shear_rate * state.box.length.y();
            particles += profile.count[k];
        }
        EXPECT_NEAR(binned_solid, solid, 1e-9 * solid);
        EXPECT_NEAR(binned_flux, flux, 1e-9 * std::abs(flux));
        EXPECT_EQ(particles, 150);
    }
}

TEST(VelocityProfile, SharesASphereThatSticksOutBetweenTopAndBottomSlab)
{
    State state;
    state.box.length = {4, 10, 4};
    state.radius = {1};
    state.position = {Vec3(2, 10, 2)};  // centre on the boundary: half above, half below
    const VelocityProfile profile = velocity_profile(state, {Vec3(10.5, 0, 0)}, 1.0, 5);
    const double half = sphere_volume(1) / 2 / (160.0 / 5);
    EXPECT_NEAR(profile.volume_fraction.front(), half, 1e-14);
    EXPECT_NEAR(profile.volume_fraction.back(), half, 1e-14);
    EXPECT_NEAR(profile.u.front(), 0.1 + 0.05, 1e-14);
    EXPECT_NEAR(profile.u.back(), 0.9 + 0.05, 1e-14);
    EXPECT_TRUE(std::isnan(profile.u[2]));
    EXPECT_EQ(profile.volume_fraction[2], 0);
}

/// Two bands: shear rate 1.6 times the mean below the middle, 0.4 times above.
TEST(VelocityProfile, RecoversTwoBands)
{
    const double shear_rate = 0.5;
    const int bins = 40;
    State state = random_state(6000, 6);
    for (double& radius : state.radius) radius = 0.1;
    std::vector<Vec3> velocity = affine_flow(state, shear_rate);
    const auto banded = [](double y) { return y < 0.5 ? 1.6 * y : 0.8 + 0.4 * (y - 0.5); };
    const double height = state.box.length.y();
    for (std::size_t i = 0; i < velocity.size(); ++i)
        velocity[i].x() = shear_rate * height * banded(state.position[i].y() / height);
    const VelocityProfile profile = velocity_profile(state, velocity, shear_rate, bins);
    for (std::size_t k = 0; k < profile.u.size(); ++k)
        EXPECT_NEAR(profile.u[k], banded(profile.y[k]), 0.6 * 0.5 / bins) << k;

    const MeanProfile mean = mean_profile({profile, profile});
    EXPECT_NEAR(mean.uniformity.largest_deviation, 0.3, 0.02);
    EXPECT_NEAR(mean.uniformity.rms_deviation, 0.3 / std::sqrt(3), 0.01);  // triangle of height 0.3
    EXPECT_NEAR(mean.uniformity.slope, 1, 0.02);  // the triangle is even about the middle
}

TEST(VelocityProfile, NamesImpossibleInput)
{
    const State state = random_state(3, 7);
    EXPECT_THROW(velocity_profile(state, affine_flow(state, 1), 1, 0), Error);
    EXPECT_THROW(velocity_profile(state, affine_flow(state, 0), 0, 10), Error);
    EXPECT_THROW(mean_profile({}), Error);
}

/// Profiles of independent noise around a line.
std::vector<VelocityProfile> synthetic(int profiles, int bins, double slope, double noise,
                                       unsigned seed)
{
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::vector<VelocityProfile> result(static_cast<std::size_t>(profiles));
    for (VelocityProfile& profile : result)
        for (int k = 0; k < bins; ++k) {
            const double y = (k + 0.5) / bins;
            profile.y.push_back(y);
            profile.u.push_back(0.5 + slope * (y - 0.5) + noise * normal(random));
            profile.volume_fraction.push_back(0.5);
            profile.count.push_back(1);
        }
    return result;
}

TEST(MeanProfile, HasTheErrorsOfIndependentNoise)
{
    const int profiles = 400, bins = 50;
    const MeanProfile mean = mean_profile(synthetic(profiles, bins, 1, 0.2, 8));
    for (const double error : mean.standard_error)
        EXPECT_NEAR(error, 0.2 / std::sqrt(profiles), 0.15 * 0.2 / std::sqrt(profiles));
    EXPECT_NEAR(mean.uniformity.chi2_per_bin, 1, 4 * std::sqrt(2.0 / bins));
    EXPECT_NEAR(mean.uniformity.slope, 1, 4 * mean.uniformity.slope_error);
    // error of a least-squares slope: noise/sqrt(sum (y - 1/2)^2), the sum being bins/12
    const double expected = 0.2 / std::sqrt(bins / 12.0) / std::sqrt(profiles);
    EXPECT_NEAR(mean.uniformity.slope_error, expected, 0.15 * expected);
}

TEST(MeanProfile, SlopeErrorCoversTheTruthInTwoThirdsOfTheCases)
{
    int covered = 0;
    for (unsigned seed = 0; seed < 300; ++seed) {
        const Uniformity u = mean_profile(synthetic(30, 20, 1, 0.1, 100 + seed)).uniformity;
        covered += std::abs(u.slope - 1) <= u.slope_error;
    }
    EXPECT_GE(covered, 180);
    EXPECT_LE(covered, 228);
}

TEST(MeanProfile, SeesAWrongSlope)
{
    const Uniformity u = mean_profile(synthetic(50, 20, 0.8, 0.05, 9)).uniformity;
    EXPECT_NEAR(u.slope, 0.8, 5 * u.slope_error);
    EXPECT_LT(u.slope_error, 0.01);
    EXPECT_GT(u.chi2_per_bin, 20);
    EXPECT_NEAR(u.largest_deviation, 0.2 * 0.475, 0.03);
}

TEST(MeanProfile, IgnoresEmptySlabsAndClaimsNoErrorFromOneProfile)
{
    std::vector<VelocityProfile> profiles = synthetic(2, 4, 1, 0, 10);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    profiles[0].u[1] = nan;
    profiles[0].u[2] = profiles[1].u[2] = nan;
    const MeanProfile mean = mean_profile(profiles);
    EXPECT_DOUBLE_EQ(mean.u[1], mean.y[1]);
    EXPECT_TRUE(std::isnan(mean.standard_error[1]));
    EXPECT_TRUE(std::isnan(mean.u[2]));
    EXPECT_NEAR(mean.uniformity.largest_deviation, 0, 1e-15);

    const MeanProfile single = mean_profile({profiles[1]});
    EXPECT_TRUE(std::isnan(single.standard_error[0]));
    EXPECT_TRUE(std::isnan(single.uniformity.slope_error));
    EXPECT_TRUE(std::isnan(single.uniformity.chi2_per_bin));
}

}
}
