#include "engine/nonaffine_field.h"

#include "engine/error.h"
#include "engine/evaluation.h"
#include "engine/pair_correlation.h"
#include "tests/support/random_state.h"

#include <gtest/gtest.h>
#include <cmath>

namespace sigmaflow {

namespace {

State random_points(int n, const Vec3& length, double offset, support::Random& random)
{
    State s;
    s.box = {length, offset};
    for (int i = 0; i < n; ++i)
        s.position.emplace_back(random.uniform(0, length.x()), random.uniform(0, length.y()),
                                random.uniform(0, length.z()));
    s.radius.assign(n, 0.1);
    return s;
}

/// cos(k z + phase) along x; k = 2 pi/Lz has the period of the box.
std::vector<Vec3> wave(const State& s, double k, double phase)
{
    std::vector<Vec3> field;
    for (const Vec3& p : s.position) field.emplace_back(std::cos(k * p.z() + phase), 0, 0);
    return field;
}

}

TEST(NonaffineField, PlaneWaveHasTheCorrelationSinKrOverKr)
{
    // averaged over directions and phases: <cos(k d_z)> = sin(kr)/(kr)
    support::Random random(1);
    const double length = 10, k = 2 * pi / length;
    std::vector<FieldCorrelation> frames;
    for (int f = 0; f < 40; ++f) {
        const State s = random_points(300, Vec3(length, length, length), 3.3, random);
        frames.push_back(
            field_correlation(s, wave(s, k, random.uniform(0, 2 * pi)), length / 2, 10));
    }
    const MeanFieldCorrelation mean = mean_field_correlation(frames, length / 2);
    for (std::size_t b = 2; b < 10; ++b) {  // narrow shells: the bin centre will do
        const double r = mean.distance[b];
        EXPECT_NEAR(mean.value[0][b].mean, std::sin(k * r) / (k * r),
                    0.01 + 4 * mean.value[0][b].standard_error);
        // along z it is the wave itself, spread by the cone of 30 degrees: cos(k r c), c in
        // [cos 30, 1]
        const double c = std::sqrt(0.75);
        EXPECT_NEAR(mean.value[3][b].mean,
                    (std::sin(k * r) - std::sin(k * r * c)) / (k * r * (1 - c)),
                    0.02 + 4 * mean.value[3][b].standard_error);
    }
    // sin(x)/x = 1/e at x = 2.12665
    const auto l = correlation_length(frames, length / 2, 0);
    ASSERT_TRUE(l);
    EXPECT_NEAR(l->length, 2.12665 / k, 0.05 + 4 * l->standard_error);
    EXPECT_GT(l->standard_error, 0);
    EXPECT_LT(l->standard_error, 0.1);
    EXPECT_FALSE(l->shorter);
    // to the first zero, half a wave: Si(pi)/k
    const auto integral = integral_length(frames, length / 2, 0);
    ASSERT_TRUE(integral);
    EXPECT_FALSE(integral->has_zero);  // at the last distance, beyond the last bin centre
    const auto along = integral_length(frames, length / 2, 3);
    ASSERT_TRUE(along);
    EXPECT_TRUE(along->has_zero);
}

TEST(NonaffineField, IntegralLengthOfAKnownCorrelation)
{
    // C = 1 - r/4 in bins of width 1; the frames scatter by a factor 1 +- 0.1
    std::vector<FieldCorrelation> frames;
    for (int f = 0; f < 100; ++f) {
        FieldCorrelation c;
        for (int k = 0; k < 8; ++k) {
            const double r = k + 0.5;
            c.value[0].push_back((1 - r / 4) * (f % 2 ? 1.1 : 0.9));
            c.pairs[0].push_back(k == 2 ? 0 : 5);  // a bin without pairs is bridged
        }
        frames.push_back(c);
    }
    const auto integral = integral_length(frames, 8, 0);
    ASSERT_TRUE(integral);
    EXPECT_TRUE(integral->has_zero);
    EXPECT_NEAR(integral->to, 4, 1e-12);
    EXPECT_NEAR(integral->length, 2, 1e-12);
    const auto l = correlation_length(frames, 8, 0);
    ASSERT_TRUE(l);
    EXPECT_NEAR(l->length, 4 * (1 - std::exp(-1)), 1e-12);
    EXPECT_FALSE(l->shorter);
    EXPECT_FALSE(integral_length({}, 8, 0));
}

TEST(NonaffineField, IndependentVelocitiesHaveNoCorrelation)
{
    support::Random random(2);
    std::vector<FieldCorrelation> frames;
    for (int f = 0; f < 50; ++f) {
        const State s = random_points(200, Vec3(8, 9, 10), 2.5, random);
        std::vector<Vec3> field;
        for (int i = 0; i < s.size(); ++i) field.push_back(random.vector());
        frames.push_back(field_correlation(s, field, 4, 8));
    }
    const MeanFieldCorrelation mean = mean_field_correlation(frames, 4);
    for (int direction = 0; direction < 4; ++direction)
        for (const Estimate& c : mean.value[direction])
            EXPECT_NEAR(c.mean, 0, 5 * c.standard_error);
    EXPECT_LT(mean.value[0].back().standard_error, 0.003);
    const auto l = correlation_length(frames, 4, 0);
    ASSERT_TRUE(l);
    EXPECT_TRUE(l->shorter);  // than the first bin
    EXPECT_NEAR(l->length, 0.25, 1e-12);
}

TEST(NonaffineField, PairsThatMoveTogetherHaveTheirExactCorrelation)
{
    // two pairs at distance 1.25 along y, velocities +-1 across the boundary above
    State s;
    s.box = {Vec3(10, 10, 10), 4};
    s.position = {{9, 9.25, 1}, {5, 0.5, 1}, {6, 5, 6}, {6, 6.25, 6}};
    s.radius.assign(4, 0.5);
    const std::vector<Vec3> field{{0, 0, 1}, {0, 0, 1}, {0, 0, -1}, {0, 0, -1}};
    const FieldCorrelation c = field_correlation(s, field, 5, 5);
    EXPECT_EQ(c.pairs[0][1], 2);
    EXPECT_EQ(c.pairs[2][1], 2);
    EXPECT_EQ(c.pairs[1][1], 0);
    EXPECT_DOUBLE_EQ(c.value[0][1], 1);
    EXPECT_DOUBLE_EQ(mean_square(field), 1);
}

TEST(NonaffineField, UniformVelocityAndImagesChangeNothing)
{
    const State s = support::dense_state(60, 0.5, 0.3, 4);
    support::Random random(9);
    std::vector<Vec3> velocity;
    for (int i = 0; i < s.size(); ++i) velocity.push_back(random.vector());
    const auto correlation = [](const State& state, const std::vector<Vec3>& v) {
        return field_correlation(state, nonaffine_field(state, v), largest_pair_distance(state.box),
                                 12);
    };
    const FieldCorrelation expected = correlation(s, velocity);
    const auto expect_same = [&](const FieldCorrelation& c) {
        for (int direction = 0; direction < 4; ++direction)
            for (int k = 0; k < 12; ++k) {
                EXPECT_EQ(c.pairs[direction][k], expected.pairs[direction][k]);
                EXPECT_NEAR(c.value[direction][k], expected.value[direction][k], 1e-12);
            }
    };
    std::vector<Vec3> moved = velocity;
    for (Vec3& v : moved) v += Vec3(3, -1, 7);
    expect_same(correlation(s, moved));
    EXPECT_NEAR(mean_square(nonaffine_field(s, moved)), mean_square(nonaffine_field(s, velocity)),
                1e-12);
    State other = s;
    other.box.offset += s.box.length.x();
    for (Vec3& p : other.position) {
        const double up = std::floor(random.uniform(-2, 3));
        p += Vec3(up * s.box.offset + std::floor(random.uniform(-2, 3)) * s.box.length.x(),
                  up * s.box.length.y(), 0);
    }
    expect_same(correlation(other, velocity));
}

TEST(NonaffineField, ForceBalanceLeavesTheFieldOfAnEvaluationAsItIs)
{
    const State s = support::dense_state(40, 0.5, 0.2, 6);
    Workspace workspace;
    const Frame f = make_frame(s, evaluate_in_detail(s, {}, ImposedStress{2}, workspace));
    const std::vector<Vec3> field = nonaffine_field(f.state, f.nonaffine_velocity);
    const double size = std::sqrt(mean_square(field));
    for (std::size_t i = 0; i < field.size(); ++i)
        EXPECT_LT((field[i] - f.nonaffine_velocity[i]).norm(), 1e-9 * size);
}

TEST(NonaffineField, ProductsOfMeansKnowThatTheirFactorsFluctuateTogether)
{
    std::mt19937 generator(8);
    std::normal_distribution<double> noise;
    std::vector<double> a, b, c;
    for (int k = 0; k < 2000; ++k) {
        const double x = noise(generator);
        b.push_back(2 + 0.1 * x);
        a.push_back(3 * b.back());
        c.push_back(4 + 0.3 * noise(generator));
    }
    EXPECT_NEAR(product_of_means(a, b, -1).mean, 3, 1e-12);
    EXPECT_NEAR(product_of_means(a, b, -1).standard_error, 0, 1e-12);
    // independent factors: relative errors 0.075/sqrt(2000) and 2 0.05/sqrt(2000) add in squares
    const Estimate p = product_of_means(c, b, -2);
    const double error = std::hypot(0.075, 0.1) / std::sqrt(2000.);
    EXPECT_NEAR(p.mean, 1, 4 * error);
    EXPECT_NEAR(p.standard_error, error, 0.4 * error);
    EXPECT_THROW(product_of_means(a, std::span(b).first(3), 1), Error);
}

TEST(NonaffineField, NoMotionAndDistancesBeyondHalfTheBoxAreRefused)
{
    const State s = support::dense_state(50, 0.4, 0, 1);
    const std::vector<Vec3> still(50, Vec3::Zero()), moving(50, Vec3(1, 0, 0));
    EXPECT_THROW(field_correlation(s, still, 2, 5), Error);
    EXPECT_THROW(field_correlation(s, moving, 1.1 * largest_pair_distance(s.box), 5), Error);
    EXPECT_NO_THROW(field_correlation(s, moving, 2, 5));
    // all move alike: the correlation does not fall
    const std::vector<FieldCorrelation> frames{field_correlation(s, moving, 3, 6)};
    EXPECT_FALSE(correlation_length(frames, 3, 0));
}

}
