#include "engine/stability.h"

#include "engine/error.h"

#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

namespace sigmaflow {

namespace {

constexpr double pi = std::numbers::pi;

UniformFlow flow(double viscosity, double slope, double relaxation)
{
    return {.viscosity = {viscosity, 0}, .slope = {slope, 0}, .relaxation = {relaxation, 0}};
}

/// The linearised model in time, independent of its dispersion relation: velocity v and stress r
/// of the mode and the memory q of the stress, all in units rho = rate = 1,
///   dv/dt = i k r,  r = eta i k v + g q,  dq/dt = c (r - q),  g = rate d eta/d stress,
/// with i absorbed in v. Returns the growth per time of the amplitude over a long time.
double growth_in_time(const UniformFlow& f, double reynolds)
{
    const double k2 = pi * pi / (reynolds * f.viscosity.mean);  // Re = H^2/eta
    const double k = std::sqrt(k2), eta = f.viscosity.mean, c = f.relaxation.mean;
    const double g = 1 - eta * f.slope.mean;  // from stress = eta rate
    struct Y {
        double v, q;
    };
    const auto rate = [&](Y y) {
        const double r = eta * k * y.v + g * y.q;
        return Y{-k * r, c * (r - y.q)};
    };
    Y y{1, 0};
    constexpr double dt = 1e-3;
    double logarithm = 0, late = 0;
    const int steps = 1000000;
    for (int n = 0; n < steps; ++n) {
        const auto plus = [](Y a, Y b, double h) { return Y{a.v + h * b.v, a.q + h * b.q}; };
        const Y a = rate(y), b = rate(plus(y, a, dt / 2)), d = rate(plus(y, b, dt / 2)),
                e = rate(plus(y, d, dt));
        y.v += dt / 6 * (a.v + 2 * b.v + 2 * d.v + e.v);
        y.q += dt / 6 * (a.q + 2 * b.q + 2 * d.q + e.q);
        const double size = std::hypot(y.v, y.q);
        logarithm += std::log(size);
        y = {y.v / size, y.q / size};
        if (n == steps / 4) late = logarithm;
    }
    return (logarithm - late) / (dt * (steps - steps / 4));
}

}

TEST(Stability, RootsSolveTheQuadraticAndAreSorted)
{
    for (const UniformFlow& f : {flow(400, -0.002, 43), flow(20, 0.04, 5), flow(1e4, -1e-5, 43)})
        for (double reynolds : {1e-4, 0.3, 1., 40., 1e6})
            for (int m : {1, 2, 7}) {
                const double damping = m * m * pi * pi / reynolds;
                const double b = damping + f.relaxation.mean * f.viscosity.mean * f.slope.mean;
                const double product = f.relaxation.mean * damping;
                const auto roots = growth_rates(f, reynolds, m);
                for (const auto& x : roots) {
                    const double scale = std::norm(x) + std::abs(b * x) + product;
                    EXPECT_LT(std::abs(x * x + b * x + product), 1e-13 * scale);
                }
                EXPECT_NEAR(std::abs(roots[0] * roots[1] - product), 0, 1e-12 * product);
                EXPECT_GE(roots[0].real(), roots[1].real());
            }
}

TEST(Stability, OnsetIsWhereAPairCrossesTheImaginaryAxis)
{
    const UniformFlow f = flow(400, -0.002, 43);
    const auto onset = onset_of_instability(f);
    ASSERT_TRUE(onset);
    EXPECT_NEAR(onset->reynolds.mean, pi * pi / (43 * 0.8), 1e-12);  // by hand
    const auto at = growth_rates(f, onset->reynolds.mean);
    EXPECT_NEAR(at[0].real(), 0, 1e-9);
    EXPECT_NEAR(at[0].imag(), onset->frequency, 1e-9);
    EXPECT_LT(growth_rates(f, 0.99 * onset->reynolds.mean)[0].real(), 0);
    EXPECT_GT(growth_rates(f, 1.01 * onset->reynolds.mean)[0].real(), 0);
    EXPECT_LT(growth_rates(f, onset->reynolds.mean, 2)[0].real(), 0);  // higher modes come later
}

TEST(Stability, ARisingCurveIsStableAtAllReynoldsNumbers)
{
    const UniformFlow f = flow(20, 0.04, 43);
    EXPECT_FALSE(onset_of_instability(f));
    EXPECT_FALSE(onset_of_instability(flow(20, 0, 43)));
    for (double reynolds : {1e-3, 1., 1e3, 1e9})
        EXPECT_LT(growth_rates(f, reynolds)[0].real(), 0) << reynolds;
}

TEST(Stability, RelativeErrorsAddInSquares)
{
    const UniformFlow f{
        .viscosity = {400, 12}, .slope = {-0.002, 0.0008}, .relaxation = {43, 43 * 0.1}};
    const auto onset = onset_of_instability(f);
    ASSERT_TRUE(onset);
    EXPECT_NEAR(onset->reynolds.standard_error / onset->reynolds.mean,
                std::sqrt(0.03 * 0.03 + 0.4 * 0.4 + 0.1 * 0.1), 1e-12);
}

TEST(Stability, GrowthIsThatOfTheModelInTime)
{
    const UniformFlow f = flow(40, -0.02, 6);
    const double critical = onset_of_instability(f)->reynolds.mean;
    for (double share : {0.3, 0.9, 1.1, 3.})
        EXPECT_NEAR(growth_in_time(f, share * critical),
                    growth_rates(f, share * critical)[0].real(), 2e-3)
            << share;
}

TEST(Stability, RefusesWhatIsNoFlow)
{
    EXPECT_THROW(onset_of_instability(flow(0, -1, 1)), Error);
    EXPECT_THROW(onset_of_instability(flow(1, std::nan(""), 1)), Error);
    EXPECT_THROW(onset_of_instability(flow(1, -1, -1)), Error);
    EXPECT_THROW(growth_rates(flow(1, -1, 1), 0), Error);
    EXPECT_THROW(growth_rates(flow(1, -1, 1), 1, 0), Error);
}

}
