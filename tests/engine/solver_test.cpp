#include "engine/solver.h"

#include "engine/error.h"
#include "engine/evaluation.h"
#include "engine/workspace.h"
#include "tests/support/random_state.h"

#include <gtest/gtest.h>

namespace sigmaflow {

using support::Random;

namespace {

struct Problem {
    ResistanceMatrix matrix;
    std::vector<Candidate> candidates;
    Velocities b, direction;
    double weight = 0;
};

Problem dense_problem(int n)
{
    State s = support::dense_state(n, 0.56, 0.4, 9);
    Random random(8);
    for (Vec3& x : s.position) x += 0.02 * random.vector();
    Workspace workspace;
    prepare(s, {}, ImposedStress{2}, workspace.buffers());
    Problem p{workspace.buffers().matrix, workspace.buffers().neighbours.candidates(), {}, {}, 0};
    for (int i = 0; i < n; ++i) {
        p.b.push_back(random.velocity());
        p.direction.push_back(random.velocity());
    }
    return p;
}

Eigen::MatrixXd dense(const ResistanceMatrix& R)
{
    const int size = 6 * R.size();
    Eigen::MatrixXd m = Eigen::MatrixXd::Zero(size, size);
    for (int i = 0; i < R.size(); ++i) m.block<6, 6>(6 * i, 6 * i) = full(R.diagonal[i]);
    for (const PairBlock& p : R.pairs) {
        m.block<6, 6>(6 * p.i, 6 * p.j) = off_diagonal(p);
        m.block<6, 6>(6 * p.j, 6 * p.i) = off_diagonal(p).transpose();
    }
    return m;
}

Eigen::VectorXd dense(const Velocities& v)
{
    Eigen::VectorXd d(6 * v.size());
    for (std::size_t i = 0; i < v.size(); ++i) d.segment<6>(6 * i) = v[i];
    return d;
}

}

TEST(ResistanceMatrix, TheCompressedProductIsTheDenseOne)
{
    const Problem p = dense_problem(40);
    Velocities product;
    multiply(p.matrix, p.b, product);
    EXPECT_LT((dense(product) - dense(p.matrix) * dense(p.b)).norm(),
              1e-12 * dense(product).norm());
}

class EverySolver : public testing::TestWithParam<SolverKind> {};

TEST_P(EverySolver, FindsTheDenseSolution)
{
    const Problem p = dense_problem(60);
    const Eigen::VectorXd expected = dense(p.matrix).llt().solve(dense(p.b));
    ResistanceSolver solver({GetParam(), 1e-12});
    solver.set_pattern(60, p.candidates);
    Velocities x;
    const SolveReport report = solver.solve({p.matrix}, p.b, x);
    EXPECT_LT((dense(x) - expected).norm(), 1e-9 * expected.norm());
    EXPECT_FALSE(report.fell_back);
    const double residual = (dense(p.b) - dense(p.matrix) * dense(x)).norm() / dense(p.b).norm();
    EXPECT_NEAR(report.residual, residual, 1e-3 * residual + 1e-14);
}

TEST_P(EverySolver, FindsTheDenseSolutionOfTheRankOneForm)
{
    Problem p = dense_problem(60);
    const Eigen::VectorXd f = dense(p.direction);
    const Eigen::MatrixXd R = dense(p.matrix);
    p.weight = 0.9 / f.dot(R.llt().solve(f));  // nearly singular: the dissipation is 10 % of R's
    const Eigen::MatrixXd A = R - p.weight * f * f.transpose();
    const Eigen::VectorXd expected = A.llt().solve(dense(p.b));
    ResistanceSolver solver({GetParam(), 1e-12});
    solver.set_pattern(60, p.candidates);
    Velocities x;
    const SolveReport report = solver.solve({p.matrix, &p.direction, p.weight}, p.b, x);
    EXPECT_LT((dense(x) - expected).norm(), 1e-8 * expected.norm());
    EXPECT_LT(report.residual, 1e-9);
}

TEST_P(EverySolver, AcceptsAGuessAndAChangedMatrix)
{
    Problem p = dense_problem(60);
    ResistanceSolver solver({GetParam(), 1e-10});
    solver.set_pattern(60, p.candidates);
    Velocities x;
    solver.solve({p.matrix}, p.b, x);
    for (int change = 0; change < 25; ++change) {
        for (DiagonalBlock& block : p.matrix.diagonal)
            for (double& value : block.translation) value *= 1.01;
        solver.solve({p.matrix}, p.b, x);
    }
    const Eigen::VectorXd expected = dense(p.matrix).llt().solve(dense(p.b));
    EXPECT_LT((dense(x) - expected).norm(), 1e-7 * expected.norm());
}

TEST_P(EverySolver, AMatrixThatIsNotPositiveDefiniteIsAnErrorThatNamesAParticle)
{
    Problem p = dense_problem(60);
    p.matrix.diagonal[17].translation[2] = -1e6;
    ResistanceSolver solver({GetParam(), 1e-10});
    solver.set_pattern(60, p.candidates);
    Velocities x;
    try {
        solver.solve({p.matrix}, p.b, x);
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::numerics);
        EXPECT_NE(std::string(error.what()).find("not positive definite"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("particle 17"), std::string::npos) << error.what();
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, EverySolver, testing::Values(SolverKind::pcg, SolverKind::cholesky),
                         [](const auto& kind) {
                             return kind.param == SolverKind::pcg ? "pcg" : "cholesky";
                         });

TEST(ConjugateGradients, AGoodGuessSavesIterations)
{
    const Problem p = dense_problem(60);
    ResistanceSolver solver({SolverKind::pcg, 1e-8});
    solver.set_pattern(60, p.candidates);
    Velocities x;
    const int cold = solver.solve({p.matrix}, p.b, x).iterations;
    for (Vec6& v : x) v *= 1 + 1e-4;
    EXPECT_LT(solver.solve({p.matrix}, p.b, x).iterations, cold);
    EXPECT_EQ(solver.solve({p.matrix}, p.b, x).iterations, 0);
}

}
