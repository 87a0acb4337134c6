#include "engine/solver.h"
#include "engine/archive.h"

#include "engine/error.h"
#include "engine/evaluation.h"
#include "engine/workspace.h"
#include "tests/support/random_state.h"

#include <gtest/gtest.h>
#include <cmath>
#include <limits>
#include <utility>

namespace sigmaflow {

using support::Random;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

struct Problem {
    std::unique_ptr<Workspace> workspace;  // holds the slices of the matrix
    ResistanceMatrix matrix;
    std::vector<Candidate> candidates;
    SlicedVector b, direction;
    double weight = 0;

    const Slices& slices() const { return *matrix.slices; }
};

SlicedVector random_vector(const Slices& slices, Random& random)
{
    Velocities v;
    for (int i = 0; i < slices.particles; ++i) v.push_back(random.velocity());
    SlicedVector sliced;
    to_slices(v, slices, sliced);
    return sliced;
}

Problem dense_problem(int n)
{
    State s = support::dense_state(n, 0.56, 0.4, 9);
    Random random(8);
    for (Vec3& x : s.position) x += 0.02 * random.vector();
    Problem p;
    p.workspace = std::make_unique<Workspace>();
    Workspace::Buffers& buffers = p.workspace->buffers();
    prepare(s, {}, ImposedStress{2}, nullptr, buffers);
    p.matrix = buffers.matrix;
    p.candidates = buffers.neighbours.candidates();
    p.b = random_vector(p.slices(), random);
    p.direction = random_vector(p.slices(), random);
    return p;
}

Eigen::MatrixXd dense(const ResistanceMatrix& R)
{
    const Slices& slices = *R.slices;
    std::vector<DiagonalSlice<d8>> blocks(slices.count + 1);
    diagonal_blocks(R, {0, slices.count}, blocks.data());
    const int size = 6 * R.size();
    Eigen::MatrixXd m = Eigen::MatrixXd::Zero(size, size);
    for (int i = 0; i < R.size(); ++i)
        m.block<6, 6>(6 * i, 6 * i) = diagonal_block(blocks.data(), slices.slot[i]);
    for (int pair : slices.pair_of) {
        const int i = slices.particle[slices.first[pair]], j = slices.particle[slices.second[pair]];
        m.block<6, 6>(6 * i, 6 * j) = off_diagonal_block(R, pair);
        m.block<6, 6>(6 * j, 6 * i) = off_diagonal_block(R, pair).transpose();
    }
    return m;
}

Eigen::VectorXd dense(const SlicedVector& v, const Slices& slices)
{
    Velocities velocities;
    from_slices(v, slices, velocities);
    Eigen::VectorXd d(6 * velocities.size());
    for (std::size_t i = 0; i < velocities.size(); ++i) d.segment<6>(6 * i) = velocities[i];
    return d;
}

void scale_drag(ResistanceMatrix& matrix, double factor)
{
    for (D8& drag : matrix.drag) drag.v *= factor;
}

}

TEST(ResistanceMatrix, TheCompressedProductIsTheDenseOne)
{
    const Problem p = dense_problem(40);
    SlicedVector product;
    multiply(p.matrix, p.b, product);
    const Eigen::VectorXd found = dense(product, p.slices());
    EXPECT_LT((found - dense(p.matrix) * dense(p.b, p.slices())).norm(), 1e-12 * found.norm());
}

class EverySolver : public testing::TestWithParam<SolverKind> {};

TEST_P(EverySolver, FindsTheDenseSolution)
{
    const Problem p = dense_problem(60);
    const Eigen::VectorXd expected = dense(p.matrix).llt().solve(dense(p.b, p.slices()));
    ResistanceSolver solver({GetParam(), 1e-12});
    solver.set_pattern(60, p.candidates);
    SlicedVector x;
    const SolveReport report = solver.solve({p.matrix}, p.b, x);
    EXPECT_LT((dense(x, p.slices()) - expected).norm(), 1e-9 * expected.norm());
    EXPECT_FALSE(report.fell_back);
    const double residual =
        (dense(p.b, p.slices()) - dense(p.matrix) * dense(x, p.slices())).norm() /
        dense(p.b, p.slices()).norm();
    EXPECT_NEAR(report.residual, residual, 1e-3 * residual + 1e-14);
}

TEST_P(EverySolver, FindsTheDenseSolutionOfTheRankOneForm)
{
    Problem p = dense_problem(60);
    const Eigen::VectorXd f = dense(p.direction, p.slices());
    const Eigen::MatrixXd R = dense(p.matrix);
    p.weight = 0.9 / f.dot(R.llt().solve(f));  // nearly singular: the dissipation is 10 % of R's
    const Eigen::MatrixXd A = R - p.weight * f * f.transpose();
    const Eigen::VectorXd expected = A.llt().solve(dense(p.b, p.slices()));
    ResistanceSolver solver({GetParam(), 1e-12});
    solver.set_pattern(60, p.candidates);
    SlicedVector x;
    const SolveReport report = solver.solve({p.matrix, &p.direction, p.weight}, p.b, x);
    EXPECT_LT((dense(x, p.slices()) - expected).norm(), 1e-8 * expected.norm());
    EXPECT_LT(report.residual, 1e-9);
}

TEST_P(EverySolver, AcceptsAGuessAndAChangedMatrix)
{
    Problem p = dense_problem(60);
    ResistanceSolver solver({GetParam(), 1e-10});
    solver.set_pattern(60, p.candidates);
    SlicedVector x;
    solver.solve({p.matrix}, p.b, x);
    for (int change = 0; change < 25; ++change) {
        scale_drag(p.matrix, 1.05);
        solver.solve({p.matrix}, p.b, x);
    }
    const Eigen::VectorXd expected = dense(p.matrix).llt().solve(dense(p.b, p.slices()));
    EXPECT_LT((dense(x, p.slices()) - expected).norm(), 1e-7 * expected.norm());
}

TEST_P(EverySolver, AMatrixThatIsNotPositiveDefiniteIsAnErrorThatNamesAParticle)
{
    Problem p = dense_problem(60);
    const int slot = p.slices().slot[17];
    p.matrix.drag[2 * (slot / lanes)].v[slot % lanes] = -1e6;
    ResistanceSolver solver({GetParam(), 1e-10});
    solver.set_pattern(60, p.candidates);
    SlicedVector x;
    try {
        solver.solve({p.matrix}, p.b, x);
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::numerics);
        EXPECT_NE(std::string(error.what()).find("not positive definite"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("particle 17"), std::string::npos) << error.what();
    }
}

TEST_P(EverySolver, AGuessThatIsNotFiniteIsNotUsed)
{
    const Problem p = dense_problem(60);
    const Eigen::VectorXd expected = dense(p.matrix).llt().solve(dense(p.b, p.slices()));
    for (double value : {nan, -infinity, 1e300}) {
        ResistanceSolver solver({GetParam(), 1e-10});
        solver.set_pattern(60, p.candidates);
        SlicedVector x = p.b;
        x[1].c[2][3] = value;
        const SolveReport report = solver.solve({p.matrix}, p.b, x);
        EXPECT_LT((dense(x, p.slices()) - expected).norm(), 1e-7 * expected.norm());
        EXPECT_FALSE(report.fell_back);
    }
}

TEST_P(EverySolver, NothingThatIsNotFiniteLeadsToASolution)
{
    const auto solve = [](const Problem& p, bool with_direction) {
        ResistanceSolver solver({GetParam(), 1e-8});
        solver.set_pattern(60, p.candidates);
        SlicedVector x;
        if (with_direction)
            solver.solve({p.matrix, &p.direction, p.weight}, p.b, x);
        else
            solver.solve({p.matrix}, p.b, x);
    };
    const auto fails = [&](const Problem& p, bool with_direction) {
        try {
            solve(p, with_direction);
        } catch (const Error& error) {
            return error.kind() == ErrorKind::numerics;
        }
        return false;
    };
    Problem p = dense_problem(60);
    const Eigen::VectorXd f = dense(p.direction, p.slices());
    p.weight = 0.5 / f.dot(dense(p.matrix).llt().solve(f));
    ASSERT_NO_THROW(solve(p, false));
    ASSERT_NO_THROW(solve(p, true));
    const int pair = p.slices().pair_of[5], slot = p.slices().slot[23];
    for (double value : {nan, infinity, -infinity}) {
        const auto try_with = [&](double& number, const char* name, bool with_direction) {
            const double sound = std::exchange(number, value);
            EXPECT_TRUE(fails(p, with_direction)) << name << " " << value;
            number = sound;
        };
        auto* group = reinterpret_cast<double*>(&p.matrix.pairs[pair / lanes]);
        for (int member = 0; member < 10; ++member)
            try_with(group[member * lanes + pair % lanes], "pair", false);
        try_with(reinterpret_cast<double*>(&p.matrix.drag[2 * (slot / lanes)])[slot % lanes],
                 "drag", false);
        auto* b = reinterpret_cast<double*>(&p.b[slot / lanes]);
        try_with(b[slot % lanes], "right-hand side", false);
        auto* direction = reinterpret_cast<double*>(&p.direction[slot / lanes]);
        try_with(direction[slot % lanes], "direction", true);
        try_with(p.weight, "weight", true);
    }
    p.weight = 1.5 / f.dot(dense(p.matrix).llt().solve(f));
    EXPECT_TRUE(fails(p, true)) << "a negative dissipation";
}

INSTANTIATE_TEST_SUITE_P(Kinds, EverySolver,
                         testing::Values(SolverKind::pcg, SolverKind::cholesky,
                                         SolverKind::lagged_cholesky),
                         [](const auto& kind) {
                             return kind.param == SolverKind::pcg        ? "pcg"
                                    : kind.param == SolverKind::cholesky ? "cholesky"
                                                                         : "lagged_cholesky";
                         });

TEST(ConjugateGradients, AGoodGuessSavesIterations)
{
    const Problem p = dense_problem(60);
    ResistanceSolver solver({SolverKind::pcg, 1e-8});
    solver.set_pattern(60, p.candidates);
    SlicedVector x;
    const int cold = solver.solve({p.matrix}, p.b, x).iterations;
    for (Slice6& slice : x)
        for (d8& c : slice.c) c *= 1 + 1e-4;
    EXPECT_LT(solver.solve({p.matrix}, p.b, x).iterations, cold);
    EXPECT_EQ(solver.solve({p.matrix}, p.b, x).iterations, 0);
}

// The error of a stiff pair is small in the norm of the preconditioner, its force is not.
TEST(Residual, BeyondTheLimitAnIterationFallsBack)
{
    Problem p = dense_problem(60);
    const int pair = p.slices().pair_of[5];
    PairGroup& group = p.matrix.pairs[pair / lanes];
    group.xa[pair % lanes] = 1e8;
    const Slices& slices = p.slices();
    const int first = slices.first[pair];
    const double normal = group.nx[pair % lanes];
    for (SolverKind kind : {SolverKind::pcg, SolverKind::lagged_cholesky}) {
        ResistanceSolver exact({SolverKind::cholesky}), solver({kind, 1e-2});
        exact.set_pattern(60, p.candidates);
        solver.set_pattern(60, p.candidates);
        SlicedVector x;
        EXPECT_LT(exact.solve({p.matrix}, p.b, x).residual, largest_direct_residual);
        x[first / lanes].c[0][first % lanes] += 3e-7 / normal;
        const SolveReport report = solver.solve({p.matrix}, p.b, x);
        EXPECT_TRUE(report.fell_back);
        EXPECT_LT(report.residual, largest_direct_residual);
    }
}

TEST(Residual, OfADirectSolutionThatIsTooLargeIsAnError)
{
    Problem p = dense_problem(60);
    for (PairGroup& group : p.matrix.pairs) group.xa *= 1e11;
    const auto fails = [](const auto& action) {
        try {
            action();
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    ResistanceSolver solver({SolverKind::cholesky});
    solver.set_pattern(60, p.candidates);
    SlicedVector x;
    const auto residual = "the limit is 1e-06";
    const std::string once = fails([&] { solver.solve({p.matrix}, p.b, x); });
    EXPECT_NE(once.find(residual), std::string::npos) << once;
    Velocities b, solution;
    from_slices(p.b, p.slices(), b);
    const std::string directly = fails([&] { solver.solve_directly(p.matrix, {&b}, {&solution}); });
    EXPECT_NE(directly.find(residual), std::string::npos) << directly;
}

TEST(Residual, OfDirectSolutionsIsReported)
{
    Problem p = dense_problem(60);
    ResistanceSolver solver({SolverKind::cholesky});
    solver.set_pattern(60, p.candidates);
    Velocities b, solution;
    from_slices(p.b, p.slices(), b);
    const SolveReport report = solver.solve_directly(p.matrix, {&b}, {&solution});
    EXPECT_GT(report.residual, 0);
    EXPECT_LT(report.residual, 1e-12);
    b[3][2] = nan;
    EXPECT_THROW(solver.solve_directly(p.matrix, {&b}, {&solution}), Error);
}

// A list of neighbours with fewer slices must not leave numbers of the longer one behind.
TEST(Residual, DoesNotRememberALargerProblem)
{
    const Problem large = dense_problem(60), small = dense_problem(40);
    SlicedVector product;
    multiply(large.matrix, large.b, product);
    multiply(large.matrix, large.b, product);
    multiply(small.matrix, small.b, product);
    EXPECT_EQ(dot(product, product), [&] {
        SlicedVector fresh;
        multiply(small.matrix, small.b, fresh);
        return dot(fresh, fresh);
    }());
}

TEST(LaggedCholesky, AStoredFactorOfOtherPairsIsRefused)
{
    const Problem p = dense_problem(60);
    ResistanceSolver solver({SolverKind::lagged_cholesky, 1e-8});
    solver.set_pattern(60, p.candidates);
    SlicedVector x;
    solver.solve({p.matrix}, p.b, x);
    ArchiveWriter stored;
    solver.save(stored);
    const auto restore = [&](int particles, std::vector<Candidate> candidates) {
        ResistanceSolver other({SolverKind::lagged_cholesky, 1e-8});
        other.set_pattern(particles, candidates);
        ArchiveReader reader(stored.bytes());
        other.restore(reader);
    };
    EXPECT_NO_THROW(restore(60, p.candidates));
    std::vector<Candidate> fewer = p.candidates;
    fewer.pop_back();
    EXPECT_THROW(restore(60, fewer), Error);
    EXPECT_THROW(restore(61, p.candidates), Error);
}

}
