#include "engine/slices.h"

#include "engine/forces/repulsion.h"
#include "engine/pair_table.h"
#include "engine/workspace.h"
#include "tests/support/random_state.h"

#include <gtest/gtest.h>
#include <map>
#include <set>

namespace sigmaflow {

namespace {

struct Sliced {
    State state;
    std::vector<Candidate> candidates;
    Slices slices;
};

// n spheres out of a dense packing
Sliced sliced(int n, double ratio = 1.4)
{
    PackingParameters p;
    p.particles = std::max(n, 60);
    p.volume_fraction = 0.5;
    p.size_ratio = ratio;
    Sliced s;
    s.state = random_packing(p);
    s.state.position.resize(n);
    s.state.radius.resize(n);
    s.state.box.offset = 0.3 * s.state.box.length.x();
    s.candidates = close_pairs(s.state, 0.5, 0.1);
    SliceMaker().make(s.state, s.candidates, s.slices);
    return s;
}

int colour_of(const Slices& s, int slot)
{
    int c = 0;
    while (s.colour[c + 1] <= slot / lanes) ++c;
    return c;
}

}

class SlicesOf : public testing::TestWithParam<int> {};

TEST_P(SlicesOf, EveryParticleHasOneSlot)
{
    const Sliced s = sliced(GetParam());
    std::set<int> seen;
    for (int i = 0; i < GetParam(); ++i) {
        EXPECT_EQ(s.slices.particle[s.slices.slot[i]], i);
        seen.insert(s.slices.slot[i]);
    }
    EXPECT_EQ(static_cast<int>(seen.size()), GetParam());
    EXPECT_EQ(static_cast<int>(s.slices.particle.size()), s.slices.slots());
}

TEST_P(SlicesOf, ParticlesThatMayInteractHaveDifferentColours)
{
    const Sliced s = sliced(GetParam());
    for (const auto [i, j] : s.candidates)
        EXPECT_NE(colour_of(s.slices, s.slices.slot[i]), colour_of(s.slices, s.slices.slot[j]));
}

TEST_P(SlicesOf, EveryPairIsMetOnceFromEitherSide)
{
    const Sliced s = sliced(GetParam());
    const Slices& slices = s.slices;
    for (std::size_t k = 0; k < s.candidates.size(); ++k) {
        const int pair = slices.pair_of[k];
        int first = slices.particle[slices.first[pair]],
            second = slices.particle[slices.second[pair]];
        EXPECT_LT(slices.first[pair], slices.second[pair]);
        if (slices.flipped[k]) std::swap(first, second);
        EXPECT_EQ(first, s.candidates[k].i);
        EXPECT_EQ(second, s.candidates[k].j);
    }
    std::map<int, int> lower;
    for (int slice = 0; slice < slices.count; ++slice)
        for (int at = slices.lower[slice] * lanes; at < slices.lower[slice + 1] * lanes; ++at) {
            const int pair = slices.lower_pair[at];
            if (pair == slices.pairs()) continue;
            ++lower[pair];
            EXPECT_EQ(slices.second[pair], slice * lanes + at % lanes);
            EXPECT_EQ(slices.first[pair], slices.lower_slot[at]);
        }
    EXPECT_EQ(lower.size(), s.candidates.size());
    for (const auto& [pair, times] : lower) EXPECT_EQ(times, 1);
    int used = 0;
    for (int second : slices.second) used += second != slices.slots();
    EXPECT_EQ(static_cast<std::size_t>(used), s.candidates.size());
}

INSTANTIATE_TEST_SUITE_P(Sizes, SlicesOf, testing::Values(1, 2, 7, 8, 9, 60, 300));

TEST(Slices, ManySmallSpheresAroundALargeOneAreSlicedToo)
{
    const Sliced s = sliced(2000, 5);
    for (const auto [i, j] : s.candidates)
        EXPECT_NE(colour_of(s.slices, s.slices.slot[i]), colour_of(s.slices, s.slices.slot[j]));
}

TEST(Slices, VectorsComeBackUnchanged)
{
    const Sliced s = sliced(60);
    support::Random random(3);
    Velocities v, back;
    for (int i = 0; i < 60; ++i) v.push_back(random.velocity());
    SlicedVector there;
    to_slices(v, s.slices, there);
    from_slices(there, s.slices, back);
    EXPECT_EQ(v, back);
}

// The same formulas eight at a time as for one pair, across the sheared boundary.
TEST(PairTable, AgreesWithTheFormulasForOnePair)
{
    State s = support::dense_state(200, 0.56, 0.37, 5);
    support::Random random(6);
    for (Vec3& x : s.position) x += 0.02 * random.vector();
    for (int i = 0; i < s.size(); i += 3) s.position[i] += Vec3(0, 0, -2 * s.box.length.z());
    Workspace workspace;
    Workspace::Buffers& b = workspace.buffers();
    const Model model;
    prepare(s, model, ImposedStress{3}, nullptr, b);
    const auto& candidates = b.neighbours.candidates();
    std::map<std::pair<int, int>, std::size_t> candidate;
    for (std::size_t k = 0; k < candidates.size(); ++k)
        candidate[{candidates[k].i, candidates[k].j}] = k;
    const auto pairs = find_pairs(s, 0.5, b.neighbours);
    ASSERT_GT(pairs.size(), 600u);
    std::set<int> in_range;
    int crossing = 0, touching = 0;
    for (const Pair& pair : pairs) {
        const std::size_t k = candidate.at({pair.i, pair.j});
        const int at = b.slices.pair_of[k], l = at % lanes;
        in_range.insert(at);
        const double sign = b.slices.flipped[k] ? -1 : 1;
        const PairGeometry& g = b.table.geometry[at / lanes];
        const PairFactors& f = b.table.factors[at / lanes];
        EXPECT_LT((sign * Vec3(g.nx[l], g.ny[l], g.nz[l]) - pair.normal).norm(), 1e-14);
        EXPECT_NEAR(g.distance[l], pair.distance, 1e-14);
        EXPECT_NEAR(g.xi[l], pair.xi, 1e-14);
        EXPECT_EQ(sign * g.image[l], pair.image);
        const auto factors = lubrication::gap_factors(pair.xi, model.lubrication_delta);
        EXPECT_NEAR(f.L[l] / factors.L, 1, 1e-11);
        EXPECT_NEAR(f.l[l] / factors.l, 1, 1e-11);
        const double expected = repulsion(pair, s.radius[pair.i], s.radius[pair.j], model);
        EXPECT_NEAR(f.repulsion[l], expected, 1e-12);
        crossing += pair.image != 0;
        touching += pair.touching();
    }
    EXPECT_GT(crossing, 20);
    EXPECT_GT(touching, 20);
    for (int at : b.slices.pair_of) {  // beyond the range nothing acts
        if (in_range.contains(at)) continue;
        EXPECT_EQ(b.table.factors[at / lanes].L[at % lanes], 0);
        EXPECT_EQ(b.table.factors[at / lanes].repulsion[at % lanes], 0);
        EXPECT_EQ(b.matrix.pairs[at / lanes].xa[at % lanes], 0);
    }
}

}
