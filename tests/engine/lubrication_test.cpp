#include "engine/lubrication/pair_resistance.h"

#include "engine/lubrication/resistance_functions.h"
#include "engine/units.h"
#include "tests/support/json_compare.h"
#include "tests/support/random_state.h"

#include <gtest/gtest.h>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

namespace sigmaflow::lubrication {

using support::Random;

namespace {

PairResistance in_six_pi(double a, double b)
{
    return scaled(pair_coefficients(a, b), 1 / reference_force, 1 / reference_force);
}

using Block = Eigen::Matrix<double, 12, 12>;

Block block_of(const PairResistance& r, const Vec3& n)
{
    Block m;
    for (int c = 0; c < 12; ++c) {
        Eigen::Matrix<double, 12, 1> unit = Eigen::Matrix<double, 12, 1>::Unit(c);
        const PairLoad load = resistance_times(r, n, unit.head<6>(), unit.tail<6>());
        m.col(c) << load.force_i, load.torque_i, load.force_j, load.torque_j;
    }
    return m;
}

Eigen::Matrix<double, 12, 1> vector_of(const PairLoad& load)
{
    Eigen::Matrix<double, 12, 1> v;
    v << load.force_i, load.torque_i, load.force_j, load.torque_j;
    return v;
}

}

// Closed forms of equal spheres: Jeffrey & Onishi (1984) and Jeffrey (1992), leading terms.
TEST(ResistanceFunctions, EqualSpheresHaveTheClassicalCoefficients)
{
    const PairResistance r = in_six_pi(1, 1);
    EXPECT_NEAR(r.xa, 1. / 4, 1e-15);
    EXPECT_NEAR(r.ya, 1. / 6, 1e-15);
    EXPECT_NEAR(r.yb11, -1. / 6, 1e-15);
    EXPECT_NEAR(r.yc11, 4. / 15, 1e-15);
    EXPECT_NEAR(r.yc12, 1. / 15, 1e-15);
    EXPECT_NEAR(r.xg11, 1. / 4, 1e-15);
    EXPECT_NEAR(r.yg11, 1. / 12, 1e-15);
    EXPECT_NEAR(r.yh11, 1. / 30, 1e-15);
    EXPECT_NEAR(r.yh12, 2. / 15, 1e-15);
    EXPECT_NEAR(r.xm11, 1. / 6, 1e-15);
    EXPECT_NEAR(r.xm12, 1. / 6, 1e-15);
    EXPECT_NEAR(r.ym11, 2. / 15, 1e-15);
    EXPECT_NEAR(r.ym12, 1. / 30, 1e-15);
}

// Fractions worked out by hand from the published functions.
TEST(ResistanceFunctions, UnequalSpheresHaveTheTabulatedCoefficients)
{
    const PairResistance r = in_six_pi(1, 1.4), q = in_six_pi(1, 3);
    EXPECT_NEAR(r.xa, 0.283564814815, 1e-12);
    EXPECT_NEAR(r.ya, 0.197685185185, 1e-12);
    EXPECT_NEAR(r.yb21, -0.299444444444, 1e-12);
    EXPECT_NEAR(r.yc22, 0.609777777778, 1e-12);
    EXPECT_NEAR(r.yh11, 0.0194444444444, 1e-13);
    EXPECT_NEAR(r.yh21, 0.190555555556, 1e-12);
    EXPECT_NEAR(r.xm22, 0.370524691358, 1e-12);
    EXPECT_NEAR(r.ym22, 0.24137037037, 1e-11);
    EXPECT_NEAR(q.xa, 0.28125, 1e-15);
    EXPECT_NEAR(q.yb21, -0.975, 1e-15);
    EXPECT_NEAR(q.yc22, 3.6, 1e-14);
    EXPECT_NEAR(q.yh11, -0.025, 1e-15);
    EXPECT_NEAR(q.ym12, 0.375, 1e-15);
}

class AnySizeRatio : public testing::TestWithParam<double> {};

TEST_P(AnySizeRatio, ExchangingTheSpheresExchangesTheScalars)
{
    const double b = GetParam();
    const PairResistance r = in_six_pi(1, b), q = in_six_pi(b, 1);
    EXPECT_NEAR(r.xa / q.xa, 1, 1e-14);
    EXPECT_NEAR(r.ya / q.ya, 1, 1e-14);
    EXPECT_NEAR(r.yb11 / q.yb21, 1, 1e-14);
    EXPECT_NEAR(r.yc11 / q.yc22, 1, 1e-14);
    EXPECT_NEAR(r.yc12 / q.yc12, 1, 1e-14);
    EXPECT_NEAR(r.xg11 / q.xg21, 1, 1e-14);
    EXPECT_NEAR(r.yg11 / q.yg21, 1, 1e-14);
    EXPECT_NEAR(r.yh12 / q.yh21, 1, 1e-14);
    EXPECT_NEAR(r.xm11 / q.xm22, 1, 1e-14);
    EXPECT_NEAR(r.xm12 / q.xm12, 1, 1e-14);
    EXPECT_NEAR(r.ym11 / q.ym22, 1, 1e-14);
    EXPECT_NEAR(r.ym12 / q.ym12, 1, 1e-14);
}

// A rigid motion of a touching pair meets no singular resistance, and an affine flow acts only
// through the relative velocity of the centres: relations between the functions, independent of any
// code.
TEST_P(AnySizeRatio, TheFunctionsObeyTheIdentitiesOfRigidMotion)
{
    const double a = 1, b = GetParam(), s = a + b;
    const PairResistance r = in_six_pi(a, b);
    const double e = 1e-14 * (1 + b * b * b);
    EXPECT_NEAR(r.xg11, a * r.xa, e);
    EXPECT_NEAR(r.xg21, b * r.xa, e);
    EXPECT_NEAR(s * r.ya, -(r.yb11 + r.yb21), e);
    EXPECT_NEAR(s * r.ya, 2 * (r.yg11 + r.yg21), e);
    EXPECT_NEAR(1.5 * (r.xm11 + r.xm12), s * r.xg11, e);
    EXPECT_NEAR(1.5 * (r.xm12 + r.xm22), s * r.xg21, e);
    EXPECT_NEAR(s * r.yg11, r.yh11 + r.yh12, e);
    EXPECT_NEAR(s * r.yg21, r.yh21 + r.yh22, e);
    EXPECT_NEAR(s * r.yg11, r.ym11 + r.ym12, e);
    EXPECT_NEAR(s * r.yb11, -(r.yc11 + r.yc12), e);
    EXPECT_NEAR(s * r.yb21, -(r.yc12 + r.yc22), e);
    EXPECT_NEAR(s * r.yb11, -2 * (r.yh11 + r.yh21), e);
    EXPECT_NEAR(s * r.yb21, -2 * (r.yh12 + r.yh22), e);
}

TEST_P(AnySizeRatio, TheBlockIsSymmetricPositiveSemidefiniteAndFreeOfRigidTranslation)
{
    Random random(11);
    for (double xi : {0.0, 1e-4, 1e-2, 0.3}) {
        const auto [L, l] = gap_factors(xi, 1e-3);
        const Block m =
            block_of(scaled(pair_coefficients(1, GetParam()), L, l), random.direction());
        const double size = m.cwiseAbs().maxCoeff();
        EXPECT_LT((m - m.transpose()).cwiseAbs().maxCoeff(), 1e-13 * size);
        EXPECT_GT(Eigen::SelfAdjointEigenSolver<Block>(m).eigenvalues().minCoeff(), -1e-12 * size);
        Eigen::Matrix<double, 12, 1> shift = Eigen::Matrix<double, 12, 1>::Zero();
        shift.segment<3>(0) = shift.segment<3>(6) = random.vector();
        EXPECT_LT((m * shift).norm(), 1e-12 * size);
    }
}

TEST_P(AnySizeRatio, AffineLoadsAndStressletsAreReciprocal)
{
    Random random(12);
    for (int trial = 0; trial < 20; ++trial) {
        const auto [L, l] = gap_factors(random.uniform(-0.1, 0.3), 1e-3);
        const PairResistance r = scaled(pair_coefficients(1, GetParam()), L, l);
        const Vec3 n = random.direction();
        const Mat3 E = random.traceless();
        const Vec6 vi = random.velocity(), vj = random.velocity();
        Eigen::Matrix<double, 12, 1> v;
        v << vi, vj;
        const double work = v.dot(vector_of(strain_load(r, n, E)));
        const PairStresslet s = velocity_stresslet(r, n, vi, vj);
        EXPECT_NEAR(work, -(s.on_i + s.on_j).cwiseProduct(E).sum(), 1e-12 * std::abs(L) * 50);
    }
}

TEST_P(AnySizeRatio, TurningTheFrameTurnsTheLoads)
{
    Random random(13);
    const auto [L, l] = gap_factors(0.01, 1e-3);
    const PairResistance r = scaled(pair_coefficients(1, GetParam()), L, l);
    const Mat3 Q = Eigen::AngleAxisd(1.1, random.direction()).toRotationMatrix();
    const Vec3 n = random.direction();
    const Vec6 vi = random.velocity(), vj = random.velocity();
    const auto turned = [&](const Vec6& v) {
        Vec6 w;
        w << Q * v.head<3>(), Q * v.tail<3>();
        return w;
    };
    const PairLoad here = resistance_times(r, n, vi, vj);
    const PairLoad there = resistance_times(r, Q * n, turned(vi), turned(vj));
    const double size = vector_of(here).norm();
    EXPECT_LT((Q * here.force_i - there.force_i).norm(), 1e-13 * size);
    EXPECT_LT((Q * here.torque_j - there.torque_j).norm(), 1e-13 * size);
}

INSTANTIATE_TEST_SUITE_P(Ratios, AnySizeRatio, testing::Values(1.0, 1.4, 1 / 1.4, 3.0, 10.0));

TEST(GapFactors, AreContinuousAtContactAndNeverNegative)
{
    const auto open = gap_factors(1e-12, 1e-3), closed = gap_factors(-0.02, 1e-3);
    EXPECT_NEAR(open.L, 1000, 1e-5);
    EXPECT_DOUBLE_EQ(closed.L, 1000);
    EXPECT_DOUBLE_EQ(closed.l, std::log(1000));
    EXPECT_DOUBLE_EQ(gap_factors(3, 1e-3).l, 0);
}

}
