// Oracles: the sample of the same frame, conservation, translations, spheres whose slab is known.
#include "engine/slab_profiles.h"

#include "engine/error.h"
#include "engine/evaluation.h"
#include "engine/velocity_profile.h"
#include "tests/support/random_state.h"

#include <gtest/gtest.h>
#include <cmath>
#include <limits>
#include <numeric>

namespace sigmaflow {

namespace {

Frame frame_of(const State& state)
{
    Workspace workspace;
    return make_frame(state, evaluate_in_detail(state, Model{}, ImposedStress{2}, workspace));
}

double mean(const std::vector<double>& values)
{
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Value k of the first list against value k + by of the second one.
void expect_moved(const std::vector<double>& one, const std::vector<double>& two, std::size_t by)
{
    for (std::size_t k = 0; k < one.size(); ++k)
        EXPECT_NEAR(one[k], two[(k + by) % two.size()], 1e-7 * (1 + std::abs(one[k]))) << k;
}

}

TEST(SlabProfiles, MeansOverTheSlabsAreThoseOfTheSample)
{
    const Frame frame = frame_of(support::dense_state(80, 0.5, 0.3, 1));
    ASSERT_GT(frame.contacts.size(), 10u);
    double solid = 0, contacts = 0, flux = 0;
    for (std::size_t i = 0; i < frame.state.radius.size(); ++i) {
        const double volume = std::pow(frame.state.radius[i], 3);
        solid += volume;
        contacts += volume * frame.contact_number[i];
        flux += volume * frame.nonaffine_velocity[i].x();
    }
    for (const Axis axis : {gradient, vorticity})
        for (const int slabs : {1, 9, 60}) {
            SCOPED_TRACE(slabs);
            const SlabProfiles p = slab_profiles(frame, axis, slabs);
            EXPECT_NEAR(mean(p.volume_fraction), 0.5, 1e-12);
            EXPECT_NEAR(mean(p.shear_stress), 2, 1e-7);
            double weighted_contacts = 0, weighted_flux = 0;
            for (std::size_t k = 0; k < p.position.size(); ++k) {
                weighted_contacts += p.volume_fraction[k] * p.frictional_contact_number[k];
                weighted_flux += p.volume_fraction[k] * p.nonaffine_velocity[k];
            }
            EXPECT_NEAR(weighted_contacts / slabs / 0.5, contacts / solid, 1e-10);
            EXPECT_NEAR(weighted_flux / slabs / 0.5, flux / solid, 1e-10);
        }
}

TEST(SlabProfiles, TranslationByWholeSlabsMovesThemAcrossTheSheredBoundary)
{
    const State state = support::dense_state(80, 0.5, 0.3, 2);
    State moved = state;
    for (Vec3& place : moved.position)
        place += Vec3(0.7, 5 * state.box.length.y() / 12, 7 * state.box.length.z() / 12);
    wrap(moved.box, moved.position);
    const Frame one = frame_of(state), two = frame_of(moved);
    for (const auto& [axis, by] : {std::pair{gradient, 5u}, std::pair{vorticity, 7u}}) {
        const SlabProfiles p = slab_profiles(one, axis, 12), q = slab_profiles(two, axis, 12);
        expect_moved(p.nonaffine_velocity, q.nonaffine_velocity, by);
        expect_moved(p.volume_fraction, q.volume_fraction, by);
        expect_moved(p.shear_stress, q.shear_stress, by);
        expect_moved(p.frictional_contact_number, q.frictional_contact_number, by);
    }
}

TEST(SlabProfiles, VelocitiesAreThoseOfTheVelocityProfile)
{
    const Frame frame = frame_of(support::dense_state(80, 0.45, 0, 3));
    const double rate = frame.sample.shear_rate, height = frame.state.box.length.y();
    const SlabProfiles p = slab_profiles(frame, gradient, 15);
    const VelocityProfile u = velocity_profile(frame.state, frame.velocity, rate, 15);
    for (std::size_t k = 0; k < u.u.size(); ++k) {
        EXPECT_NEAR(p.nonaffine_velocity[k] / (rate * height), u.u[k] - u.y[k], 1e-10);
        EXPECT_DOUBLE_EQ(p.volume_fraction[k], u.volume_fraction[k]);
    }
}

TEST(SlabProfiles, AnEmptySlabLiesBetweenItsNeighbours)
{
    Frame frame;
    frame.state.box.length = {10, 60, 10};
    frame.state.radius = {1, 1};
    frame.state.position = {Vec3(1, 5, 1), Vec3(5, 35, 5)};  // in slabs 0 and 3 of 6
    frame.nonaffine_velocity = {Vec3(3, 0, 0), Vec3(-3, 0, 0)};
    frame.particle_stress = {Mat3::Zero(), Mat3::Zero()};
    const SlabProfiles p = slab_profiles(frame, gradient, 6);
    const std::vector<double> expected{3, 1, -1, -3, -1, 1};
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(p.nonaffine_velocity[k], expected[k], 1e-12);
    EXPECT_EQ(p.volume_fraction[1], 0);
}

// u - y rises by 0.15 through one half of the box and falls through the other: rates 1.3 and 0.7.
TEST(LocalShearRate, OfATriangleIsThatOfTwoBands)
{
    const int slabs = 20;
    const double rate = 0.2, height = 7;
    std::vector<double> velocity;
    for (int k = 0; k < slabs; ++k) {
        const double y = (k + 0.5) / slabs;
        velocity.push_back(rate * height * 0.3 * (y < 0.5 ? y : 1 - y));
    }
    const std::vector<double> local = local_shear_rate(velocity, rate, height);
    for (std::size_t k = 0; k < 20; ++k)
        EXPECT_NEAR(local[k], k == 9 || k == 19 ? 1 : k < 9 ? 1.3 : 0.7, 1e-12) << k;
    EXPECT_NEAR(mean(local), 1, 1e-12);
}

TEST(SlabProfiles, NameImpossibleInput)
{
    const Frame frame = frame_of(support::dense_state(50, 0.3, 0, 4));
    EXPECT_THROW(slab_profiles(frame, gradient, 0), Error);
    EXPECT_THROW(slab_profiles(Frame{}, gradient, 4), Error);
    EXPECT_THROW(local_shear_rate({1, 2}, 0, 1), Error);
    EXPECT_THROW(local_shear_rate({1, 2}, std::numeric_limits<double>::quiet_NaN(), 1), Error);
}

}
