#include "engine/pairs.h"

#include "tests/support/random_state.h"

#include <gtest/gtest.h>

namespace sigmaflow {

using support::Random;

namespace {

std::vector<std::pair<int, int>> keys(const std::vector<Pair>& pairs)
{
    std::vector<std::pair<int, int>> result;
    for (const Pair& p : pairs) result.emplace_back(p.i, p.j);
    return result;
}

// The slow twin: every pair of particles.
std::vector<std::pair<int, int>> all_pairs_in_range(const State& s, double range)
{
    std::vector<std::pair<int, int>> result;
    for (int i = 0; i < s.size(); ++i)
        for (int j = i + 1; j < s.size(); ++j) {
            const double sum = s.radius[i] + s.radius[j];
            const double r = separation(s.box, s.position[i], s.position[j]).d.norm();
            if (2 * (r - sum) / sum < range) result.emplace_back(i, j);
        }
    return result;
}

State random_state(Random& random, int n, const Vec3& box, double largest)
{
    State s;
    s.box.length = box;
    s.box.offset = random.uniform(0, box.x());
    for (int i = 0; i < n; ++i) {
        s.position.push_back(random.vector().cwiseAbs().cwiseProduct(box));
        s.radius.push_back(i % 2 ? 1. : largest);
    }
    return s;
}

}

TEST(Pairs, TheCellListFindsWhatAllPairsFindAcrossTheShearedBoundary)
{
    Random random(4);
    for (int trial = 0; trial < 60; ++trial) {
        const Vec3 box(random.uniform(14, 30), random.uniform(12, 30), random.uniform(12, 30));
        const State s = random_state(random, 300, box, trial % 3 ? 1.4 : 1.1);
        NeighbourList list;
        list.update(s, 0.5);
        EXPECT_EQ(keys(find_pairs(s, 0.5, list)), all_pairs_in_range(s, 0.5)) << "trial " << trial;
    }
}

TEST(Pairs, PositionsManyCellsAwayGiveTheSamePairs)
{
    Random random(5);
    State s = random_state(random, 300, Vec3(20, 16, 15), 1.4);
    NeighbourList list;
    list.update(s, 0.5);
    const auto before = keys(find_pairs(s, 0.5, list));
    for (int i = 0; i < s.size(); i += 3)
        s.position[i] += Vec3(-2 * 20 + 5 * s.box.offset, 5 * 16, 3 * 15);
    NeighbourList fresh;
    fresh.update(s, 0.5);
    EXPECT_EQ(keys(find_pairs(s, 0.5, fresh)), before);
}

TEST(Pairs, ABoxBeyondTheRangeOfIntegersHasItsPairs)
{
    State s;
    s.box.length = Vec3(1e200, 1e197, 1e190);
    s.position = {Vec3(1, 1, 1), Vec3(3.1, 1, 1), Vec3(5e199, 2e196, 3e189)};
    s.radius = {1, 1, 1};
    NeighbourList list;
    list.update(s, 0.5);
    EXPECT_EQ(keys(find_pairs(s, 0.5, list)), (std::vector<std::pair<int, int>>{{0, 1}}));
}

TEST(Pairs, TheListStaysCompleteWhileTheSuspensionFlows)
{
    Random random(6);
    State s = random_state(random, 400, Vec3(20, 19, 18), 1.4);
    NeighbourList list;
    int rebuilds = 0;
    for (int step = 0; step < 400; ++step) {
        const double dgamma = random.uniform(-0.002, 0.006);
        for (Vec3& x : s.position) x += Vec3(dgamma * x.y(), 0, 0) + 2e-3 * random.vector();
        s.box.offset += dgamma * s.box.length.y();
        s.strain += dgamma;
        if (step % 2) wrap(s.box, s.position);
        rebuilds += list.update(s, 0.5);
        ASSERT_EQ(keys(find_pairs(s, 0.5, list)), all_pairs_in_range(s, 0.5)) << "step " << step;
    }
    EXPECT_GT(rebuilds, 5);
    EXPECT_LT(rebuilds, 200);  // otherwise the list would save nothing
}

TEST(Pairs, TheListNoticesAJumpOfTheBoundaryWithoutStrain)
{
    Random random(7);
    State s = random_state(random, 300, Vec3(20, 19, 18), 1.4);
    NeighbourList list;
    list.update(s, 0.5);
    s.box.offset += 5;
    EXPECT_TRUE(list.update(s, 0.5));
    EXPECT_EQ(keys(find_pairs(s, 0.5, list)), all_pairs_in_range(s, 0.5));
}

}
