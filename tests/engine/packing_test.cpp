#include "engine/packing.h"

#include "engine/error.h"
#include "engine/pairs.h"

#include <gtest/gtest.h>
#include <algorithm>

namespace sigmaflow {

namespace {

double smallest_xi(const State& s)
{
    double smallest = 1e9;
    for (int i = 0; i < s.size(); ++i)
        for (int j = i + 1; j < s.size(); ++j) {
            const double sum = s.radius[i] + s.radius[j];
            smallest = std::min(
                smallest,
                2 * (separation(s.box, s.position[i], s.position[j]).d.norm() - sum) / sum);
        }
    return smallest;
}

}

TEST(Packing, ReachesTheAskedVolumeFractionWithoutOverlaps)
{
    for (double phi : {0.05, 0.40, 0.56, 0.60}) {
        PackingParameters p;
        p.particles = 100;
        p.volume_fraction = phi;
        const State s = random_packing(p);
        EXPECT_NEAR(volume_fraction(s), phi, 1e-14);
        EXPECT_GT(smallest_xi(s), 0) << phi;
    }
}

TEST(Packing, TheDensestMixtureOfTheModelCanBePacked)
{
    PackingParameters p;
    p.particles = 200;
    p.volume_fraction = 0.62;
    const State s = random_packing(p);
    EXPECT_NEAR(volume_fraction(s), 0.62, 1e-14);
    EXPECT_GT(smallest_xi(s), 0);
}

TEST(Packing, EqualVolumesOfSmallAndLargeGiveTheNumbersOfThePaper)
{
    PackingParameters p;
    p.particles = 500;
    p.volume_fraction = 0.3;
    const State s = random_packing(p);
    EXPECT_EQ(std::count(s.radius.begin(), s.radius.end(), 1.), 366);
    EXPECT_EQ(std::count(s.radius.begin(), s.radius.end(), 1.4), 134);
}

TEST(Packing, TheSeedDecidesEverything)
{
    PackingParameters p;
    p.particles = 60;
    const State one = random_packing(p), two = random_packing(p);
    EXPECT_EQ(one.position, two.position);
    p.seed = 2;
    EXPECT_NE(one.position, random_packing(p).position);
}

TEST(Packing, GivenRadiiAndBoxShapeAreKept)
{
    PackingParameters p;
    p.radii = {1, 2, 1.5, 1, 1, 1, 1.2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
    p.volume_fraction = 0.1;
    p.box_shape = Vec3(2, 1, 1);
    const State s = random_packing(p);
    EXPECT_EQ(s.radius, p.radii);
    EXPECT_NEAR(s.box.length.x() / s.box.length.y(), 2, 1e-14);
    EXPECT_NEAR(volume_fraction(s), 0.1, 1e-14);
}

TEST(Packing, RefusesWhatCannotBe)
{
    const auto kind = [](int particles, double phi, int iterations = 200000) {
        PackingParameters p;
        p.particles = particles;
        p.volume_fraction = phi;
        p.max_iterations = iterations;
        try {
            random_packing(p);
        } catch (const Error& error) {
            return error.kind();
        }
        return ErrorKind::internal;
    };
    EXPECT_EQ(kind(500, 0.7), ErrorKind::input);
    EXPECT_EQ(kind(0, 0.5), ErrorKind::input);
    EXPECT_EQ(kind(3, 0.5), ErrorKind::input);
    EXPECT_EQ(kind(200, 0.64, 50), ErrorKind::numerics);
}

TEST(RandomClosePacking, FollowsTheDistributionOfTheRadii)
{
    const auto mixture = [](double ratio, double share, int particles = 1000) {
        PackingParameters p;
        p.particles = particles;
        p.size_ratio = ratio;
        p.small_volume_share = share;
        return random_close_packing(packing_radii(p));
    };
    for (double share : {0., 0.5, 1.}) EXPECT_EQ(mixture(1, share), 0.64);
    EXPECT_EQ(mixture(1.4, 0), 0.64);
    EXPECT_EQ(mixture(3, 1), 0.64);
    // 0.73 of the spheres are small: d = 0.160, S = 1.05
    EXPECT_NEAR(mixture(1.4, 0.5), 0.6528, 1e-4);
    EXPECT_GT(mixture(2, 0.5), mixture(1.4, 0.5));
    // spheres of infinite ratio fill 1/(0.5 + 0.5/0.64)
    EXPECT_NEAR(mixture(10, 0.5, 100000), 0.7805, 2e-4);
    EXPECT_LT(mixture(10, 0.27, 100000), 0.64 + 0.36 * 0.64 + 1e-3);
    EXPECT_EQ(random_close_packing({0.01, 1, 1, 1, 1, 1, 1, 1, 1, 1}), 0.64);  // fills no void
}

}
