#include "engine/pair_correlation.h"

#include "engine/error.h"
#include "engine/units.h"
#include "tests/support/random_state.h"

#include <gtest/gtest.h>
#include <cmath>
#include <numeric>

namespace sigmaflow {

namespace {

State ideal_gas(int n, const Vec3& length, double offset, support::Random& random)
{
    State s;
    s.box = {length, offset};
    for (int i = 0; i < n; ++i) {
        s.position.emplace_back(random.uniform(0, length.x()), random.uniform(0, length.y()),
                                random.uniform(0, length.z()));
        s.radius.push_back(i % 3 ? 0.1 : 0.14);
    }
    return s;
}

/// A simple cubic lattice of m^3 points at distance 1 that the box has sheared by `strain`.
State sheared_lattice(int m, double strain)
{
    State s;
    const double length = m;
    s.box = {Vec3(length, length, length), strain * length};
    for (int k = 0; k < m * m * m; ++k) {
        const Vec3 p(k % m, k / m % m, k / m / m);
        s.position.emplace_back(p.x() + strain * p.y(), p.y(), p.z());
        s.radius.push_back(0.4);
    }
    wrap(s.box, s.position);
    return s;
}

/// How many neighbours a particle has in the bin of a distance.
double neighbours_at(double r, const PairCorrelation& g, const CorrelationGrid& grid,
                     const State& s)
{
    const double width = grid.largest_distance / grid.bins, bin = std::floor(r / width);
    const double shell = 4 * pi / 3 * (std::pow((bin + 1) * width, 3) - std::pow(bin * width, 3));
    return g.all[static_cast<std::size_t>(bin)] * shell * (s.size() - 1) / s.box.volume();
}

void expect_same(const PairCorrelation& a, const PairCorrelation& b)
{
    const auto near = [](const std::vector<double>& u, const std::vector<double>& v) {
        ASSERT_EQ(u.size(), v.size());
        for (std::size_t k = 0; k < u.size(); ++k) EXPECT_NEAR(u[k], v[k], 1e-9);
    };
    near(a.all, b.all);
    near(a.map, b.map);
    near(a.near, b.near);
    EXPECT_NEAR(a.quadrant_anisotropy, b.quadrant_anisotropy, 1e-12);
}

}

TEST(PairCorrelation, OfAnIdealGasIsOneEverywhere)
{
    support::Random random(4);
    CorrelationGrid grid;
    grid.largest_distance = 4;  // up to half of the smallest length
    grid.bins = 8;
    grid.map_bins = 4;
    grid.angles = 6;
    grid.near_xi = 15;
    std::vector<PairCorrelation> frames;
    for (int k = 0; k < 100; ++k)
        frames.push_back(pair_correlation(ideal_gas(150, Vec3(10, 8, 9), 0.37 * 10, random), grid));
    const MeanPairCorrelation mean = mean_pair_correlation(frames);
    double chi2 = 0;
    int values = 0;
    const auto check = [&](const std::vector<Estimate>& list) {
        for (const Estimate& g : list) {
            EXPECT_NEAR(g.mean, 1, 5 * g.standard_error);
            chi2 += std::pow((g.mean - 1) / g.standard_error, 2);
            ++values;
        }
    };
    check(mean.all);
    check(mean.map);
    check(mean.near);
    ASSERT_EQ(mean.by_species.size(), 3u);
    for (const auto& g : mean.by_species) check(g);
    EXPECT_LT(chi2 / values, 1.5);
    EXPECT_GT(chi2 / values, 0.5);
    EXPECT_LT(mean.all.back().standard_error, 0.01);
    EXPECT_NEAR(mean.quadrant_anisotropy.mean, 0, 4 * mean.quadrant_anisotropy.standard_error);
}

TEST(PairCorrelation, OfASimpleCubicLatticeHasItsShells)
{
    CorrelationGrid grid;
    grid.largest_distance = 2.5;
    grid.bins = 47;  // no shell at an edge
    grid.near_xi = 1;
    const State s = sheared_lattice(5, 0);
    const PairCorrelation g = pair_correlation(s, grid);
    const auto shell = [&](double r) { return neighbours_at(r, g, grid, s); };
    EXPECT_NEAR(shell(1), 6, 1e-9);
    EXPECT_NEAR(shell(std::sqrt(2)), 12, 1e-9);
    EXPECT_NEAR(shell(std::sqrt(3)), 8, 1e-9);
    EXPECT_NEAR(shell(2), 6, 1e-9);
    EXPECT_NEAR(shell(std::sqrt(5)), 24, 1e-9);
    EXPECT_NEAR(g.near_neighbours, 6, 1e-12);
    EXPECT_EQ(g.by_species.size(), 0u);
    double sum = 0;
    for (double value : g.all) sum += value > 0;
    EXPECT_EQ(sum, 6);  // also sqrt(6)
}

TEST(PairCorrelation, SeesTheShearedLatticeAcrossTheBoundary)
{
    // rows displaced by 0.4 a layer: neighbours above at (0.4, 1) and (-0.6, 1)
    CorrelationGrid grid;
    grid.largest_distance = 2.4;
    grid.bins = 37;            // no shell at an edge
    grid.near_xi = 0.4 / 0.8;  // up to 1, not included
    grid.slab = 0.1;
    grid.map_bins = 24;
    grid.angles = 180;
    const State s = sheared_lattice(5, 0.4);
    const PairCorrelation g = pair_correlation(s, grid);
    const auto shell = [&](double r) { return neighbours_at(r, g, grid, s); };
    EXPECT_NEAR(shell(std::hypot(0.4, 1)), 2, 1e-9);
    EXPECT_NEAR(shell(std::hypot(0.6, 1)), 2, 1e-9);
    EXPECT_NEAR(shell(1), 4, 1e-9);
    const int ring = static_cast<int>(std::hypot(0.4, 1) / 0.1);
    const double theta = std::atan2(1, 0.4) * 180 / pi;
    for (int angle = 0; angle < 180; ++angle) {
        const double value = g.map[ring * 180 + angle];
        if (angle == static_cast<int>(theta)) {
            EXPECT_GT(value, 100);
        } else if (angle != 0 && angle != 179) {  // neighbours along the flow share the ring
            EXPECT_EQ(value, 0) << angle;
        }
    }
}

TEST(PairCorrelation, DirectionsOfNearNeighboursAndQuadrants)
{
    State s;
    s.box = {Vec3(20, 20, 20), 5};
    const auto pair = [&](const Vec3& at, double degrees) {
        s.position.push_back(at);
        s.position.push_back(
            at + 2 * Vec3(std::cos(degrees * pi / 180), std::sin(degrees * pi / 180), 0));
    };
    pair({1, 1, 1}, 135);
    pair({10, 19.5, 1}, 137 + 180);  // the same bin
    pair({10, 10, 10}, 137);
    pair({1, 10, 10}, 42);
    s.radius.assign(s.position.size(), 1);
    CorrelationGrid grid;
    grid.angles = 18;
    const PairCorrelation g = pair_correlation(s, grid);
    EXPECT_NEAR(g.quadrant_anisotropy, 0.5, 1e-12);
    EXPECT_NEAR(g.near_neighbours, 1, 1e-12);
    for (int k = 0; k < 18; ++k)
        EXPECT_NEAR(g.near[k], 18 * (k == 13 ? 0.75 : k == 4 ? 0.25 : 0), 1e-12) << k;
    EXPECT_NEAR(grid.angle(13), 135, 1e-12);
}

TEST(PairCorrelation, DoesNotDependOnImagesOrThePeriodOfTheOffset)
{
    const State s = support::dense_state(60, 0.5, 0.3, 2);
    CorrelationGrid grid;
    grid.largest_distance = largest_pair_distance(s.box);
    const PairCorrelation expected = pair_correlation(s, grid);
    State other = s;
    other.box.offset += s.box.length.x();
    expect_same(pair_correlation(other, grid), expected);
    other = s;
    support::Random random(7);
    for (Vec3& p : other.position) {
        const double up = std::floor(random.uniform(-2, 3));
        p += Vec3(up * s.box.offset + std::floor(random.uniform(-2, 3)) * s.box.length.x(),
                  up * s.box.length.y(), std::floor(random.uniform(-2, 3)) * s.box.length.z());
    }
    expect_same(pair_correlation(other, grid), expected);
    other = s;
    for (Vec3& p : other.position) p += Vec3(1.3, 4.7, -2.2);
    wrap(other.box, other.position);
    expect_same(pair_correlation(other, grid), expected);
}

TEST(PairCorrelation, CountsEveryPairOnceAgainstAllImages)
{
    // slow twin: 5 x 3 x 3 images of every particle, whichever of them lie within reach
    const State s = support::dense_state(50, 0.45, 0.45, 5);
    CorrelationGrid grid;
    grid.largest_distance = largest_pair_distance(s.box);
    grid.bins = 1;
    grid.map_bins = 1;
    grid.angles = 1;
    grid.slab = 1;
    double pairs = 0;
    for (int i = 0; i < s.size(); ++i)
        for (int j = 0; j < s.size(); ++j)
            for (int x = -2; x <= 2; ++x)
                for (int y = -1; y <= 1; ++y)
                    for (int z = -1; z <= 1; ++z) {
                        const Vec3 d = s.position[j] - s.position[i] +
                                       Vec3(x * s.box.length.x() + y * s.box.offset,
                                            y * s.box.length.y(), z * s.box.length.z());
                        pairs += i != j && d.norm() < grid.largest_distance;
                    }
    const PairCorrelation g = pair_correlation(s, grid);
    const double n = s.size(), sphere = 4 * pi / 3 * std::pow(grid.largest_distance, 3);
    EXPECT_NEAR(g.all[0], pairs * s.box.volume() / (n * (n - 1) * sphere), 1e-9);
    EXPECT_NEAR(g.map[0], g.all[0], 1e-9);  // a slab of all directions
    // species weighted by their pairs
    const double large = std::accumulate(s.radius.begin(), s.radius.end(), 0.,
                                         [](double sum, double r) { return sum + (r > 1.2); });
    const double small = n - large;
    EXPECT_NEAR((small * (small - 1) * g.by_species[0][0] + 2 * small * large * g.by_species[1][0] +
                 large * (large - 1) * g.by_species[2][0]) /
                    (n * (n - 1)),
                g.all[0], 1e-9);
}

TEST(PairCorrelation, BeyondHalfTheBoxIsRefused)
{
    const State s = support::dense_state(50, 0.45, 0.1, 5);
    CorrelationGrid grid;
    grid.largest_distance = 1.01 * largest_pair_distance(s.box);
    EXPECT_THROW(pair_correlation(s, grid), Error);
    grid.largest_distance = 2;
    EXPECT_NO_THROW(pair_correlation(s, grid));
    grid.near_xi = 5;
    EXPECT_THROW(pair_correlation(s, grid), Error);
    grid.near_xi = 0.1;
    grid.slab = 0;
    EXPECT_THROW(pair_correlation(s, grid), Error);
    EXPECT_THROW(pair_correlation({}, {}), Error);
}

TEST(PairCorrelation, HighestPeakIsFound)
{
    CorrelationGrid grid;
    grid.largest_distance = 4;
    grid.bins = 4;
    std::vector<Estimate> g(4);
    g[2].mean = 3;
    g[2].standard_error = 0.5;
    const Peak peak = highest_peak(g, grid);
    EXPECT_EQ(peak.distance, 2.5);
    EXPECT_EQ(peak.height.mean, 3);
    EXPECT_EQ(peak.height.standard_error, 0.5);
}

}
