#include "engine/stability.h"

#include "engine/argument_principle.h"
#include "engine/error.h"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

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

using Complex = std::complex<double>;

MemoryFlow memory_flow(double viscosity, double slope, std::vector<double> weights,
                       std::vector<double> c, double instantaneous = 0)
{
    MemoryFlow f{.viscosity = {viscosity, 0}, .slope = {slope, 0}, .kernel = {}};
    for (std::size_t i = 0; i < c.size(); ++i)
        f.kernel.terms.push_back({{weights[i], 0}, {c[i], 0}});
    f.kernel.instantaneous = instantaneous;
    return f;
}

class Random {
public:
    explicit Random(unsigned seed) : generator_(seed) {}
    double uniform(double low, double high)
    {
        return std::uniform_real_distribution<double>(low, high)(generator_);
    }

private:
    std::mt19937 generator_;
};

/// Random flows on the falling part of a curve with up to four exponentials of positive weights.
MemoryFlow random_flow(Random& random, int terms)
{
    const double viscosity = std::pow(10, random.uniform(0.5, 4));
    const double w0 = -random.uniform(0, 5);
    std::vector<double> weights, c;
    double sum = 0;
    for (int i = 0; i < terms; ++i) {
        weights.push_back(random.uniform(0.1, 1));
        c.push_back(std::pow(10, random.uniform(0, 3.5)));
        sum += weights.back();
    }
    for (double& w : weights) w *= (1 - w0) / sum;
    return memory_flow(viscosity, -random.uniform(0.05, 3) / viscosity, weights, c, w0);
}

/// The eigenvalues of the linear differential equations of rate r and memories z_i of the stress,
///   r' = -D stress, z_i' = c_i (stress - z_i), stress (1 - g w_0) = r + g sum_i w_i z_i.
std::vector<Complex> eigenvalues(const MemoryFlow& f, double reynolds, int mode)
{
    const auto n = static_cast<Eigen::Index>(f.kernel.terms.size());
    const double d = std::pow(mode * pi, 2) / reynolds;
    const double g = 1 - f.viscosity.mean * f.slope.mean;
    Eigen::VectorXd stress(n + 1);
    stress[0] = 1;
    for (Eigen::Index i = 0; i < n; ++i)
        stress[i + 1] = g * f.kernel.terms[static_cast<std::size_t>(i)].weight.mean;
    stress /= 1 - g * f.kernel.instantaneous;
    Eigen::MatrixXd m(n + 1, n + 1);
    m.row(0) = -d * stress.transpose();
    for (Eigen::Index i = 0; i < n; ++i) {
        const double c = f.kernel.terms[static_cast<std::size_t>(i)].c.mean;
        m.row(i + 1) = c * stress.transpose();
        m(i + 1, i + 1) -= c;
    }
    const Eigen::VectorXcd values = m.eigenvalues();
    std::vector<Complex> result(values.begin(), values.end());
    std::sort(result.begin(), result.end(), [](const Complex& a, const Complex& b) {
        return a.real() != b.real() ? a.real() > b.real() : a.imag() > b.imag();
    });
    return result;
}

int with_positive_real_part(const std::vector<Complex>& roots)
{
    return static_cast<int>(
        std::count_if(roots.begin(), roots.end(), [](const Complex& x) { return x.real() > 0; }));
}

/// Golden: where the largest real part changes its sign, by bisection of ln Re.
double critical_by_bisection(const MemoryFlow& f, double low, double high)
{
    for (int k = 0; k < 60; ++k) {
        const double middle = std::sqrt(low * high);
        (eigenvalues(f, middle, 1)[0].real() > 0 ? high : low) = middle;
    }
    return low;
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

// The general memory.

TEST(Stability, OneExponentialIsThePapersCase)
{
    for (const UniformFlow& f : {flow(400, -0.002, 43), flow(20, 0.04, 5), flow(1e4, -1e-4, 43)}) {
        const MemoryFlow general{
            .viscosity = f.viscosity, .slope = f.slope, .kernel = exponential_kernel(f.relaxation)};
        EXPECT_NEAR(instantaneous_viscosity(general), f.viscosity.mean, 1e-9 * f.viscosity.mean);
        for (double reynolds : {1e-3, 0.3, 40., 1e4})
            for (int m : {1, 3}) {
                const auto expected = growth_rates(f, reynolds, m);
                const auto found = growth_rates(general, reynolds, m);
                ASSERT_EQ(found.size(), 2u);
                for (std::size_t i = 0; i < 2; ++i)
                    EXPECT_LT(std::abs(found[i] - expected[i]), 1e-9 * std::abs(expected[i]));
            }
        const auto expected = onset_of_instability(f), found = onset_of_instability(general);
        ASSERT_EQ(found.has_value(), expected.has_value());
        if (!found) continue;
        EXPECT_NEAR(found->reynolds.mean / expected->reynolds.mean, 1, 1e-10);
        EXPECT_NEAR(found->frequency / expected->frequency, 1, 1e-10);
    }
}

TEST(Stability, RootsAreTheEigenvaluesOfTheLinearSystem)
{
    Random random(3);
    for (int trial = 0; trial < 200; ++trial) {
        const MemoryFlow f = random_flow(random, 1 + trial % 4);
        const double reynolds = std::pow(10, random.uniform(-3, 3));
        const int mode = 1 + trial % 3;
        const auto expected = eigenvalues(f, reynolds, mode);
        const auto found = growth_rates(f, reynolds, mode);
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_LT(std::abs(found[i] - expected[i]), 1e-6 * (std::abs(expected[i]) + 1e-3));
        }
    }
}

TEST(Stability, ArgumentPrincipleCountsTheRootsOfThePolynomial)
{
    Random random(5);
    int unstable = 0;
    for (int trial = 0; trial < 300; ++trial) {
        const MemoryFlow f = random_flow(random, 1 + trial % 4);
        const double reynolds = std::pow(10, random.uniform(-4, 4));
        const int expected = with_positive_real_part(growth_rates(f, reynolds));
        EXPECT_EQ(unstable_roots(f, reynolds), expected) << trial;
        unstable += expected > 0;
    }
    EXPECT_GT(unstable, 50);
    EXPECT_LT(unstable, 250);
}

TEST(Stability, ArgumentPrincipleFindsKnownZeros)
{
    const auto polynomial = [](Complex x) { return (x - 1.) * (x * x - 0.2 * x + 4.) * (x + 3.); };
    EXPECT_EQ(zeros_in_right_half_plane(polynomial, 10), 3);
    EXPECT_EQ(zeros_in_right_half_plane([](Complex x) { return x + 1e-9; }, 1), 0);
    // y' = -a y(t - 1) decays for a < pi/2, and every 2 pi of a a further pair grows (Hayes 1950)
    for (const auto& [a, zeros] : {std::pair(1.55, 0), {1.6, 2}, {7.8, 2}, {7.9, 4}, {14.2, 6}}) {
        const auto delay = [a = a](Complex x) { return x + a * std::exp(-x); };
        EXPECT_EQ(zeros_in_right_half_plane(delay, 2 * a), zeros) << a;
    }
    EXPECT_THROW(zeros_in_right_half_plane([](Complex x) { return x * x + 1.; }, 3), Error);
    EXPECT_THROW(zeros_in_right_half_plane(polynomial, 0), Error);
}

TEST(Stability, OnsetOfAnyMemoryIsWhereTheGrowthChangesItsSign)
{
    Random random(7);
    for (int trial = 0; trial < 60; ++trial) {
        const MemoryFlow f = random_flow(random, 1 + trial % 4);
        const auto onset = onset_of_instability(f);
        ASSERT_TRUE(onset);
        const double critical = onset->reynolds.mean;
        EXPECT_NEAR(critical_by_bisection(f, critical / 100, critical * 100) / critical, 1, 1e-6);
        EXPECT_NEAR(*reynolds_of_growth(f, 0) / critical, 1, 1e-6);
        const Complex root = eigenvalues(f, critical, 1)[0];
        EXPECT_NEAR(std::abs(root.imag()) / onset->frequency, 1, 1e-5);
        EXPECT_LT(std::abs(dispersion(f, critical, 1, Complex(0, onset->frequency))),
                  1e-6 * onset->frequency);
        EXPECT_EQ(unstable_roots(f, 0.99 * critical), 0);
        EXPECT_EQ(unstable_roots(f, 1.01 * critical), 2);
        // higher modes grow later and less
        for (double factor : {1.5, 10., 1e3})
            EXPECT_LT(growth_rates(f, factor * critical, 2)[0].real(),
                      growth_rates(f, factor * critical)[0].real());
    }
}

// Adding a part of the memory that follows nearly at once leaves the rest to decide.
TEST(Stability, SlowMemoryDecidesTheOnset)
{
    const double eta = 400, slope = -0.002, c = 43;
    const double paper = onset_of_instability(flow(eta, slope, c))->reynolds.mean;
    // one exponential with a hydrodynamic instantaneous viscosity: same Re_c, slower oscillation
    MemoryFlow f = memory_flow(eta, slope, {1}, {c});
    f.instantaneous_viscosity = 9.5;
    EXPECT_NEAR(instantaneous_viscosity(f), 9.5, 1e-12);
    EXPECT_NEAR(onset_of_instability(f)->reynolds.mean / paper, 1, 1e-10);
    EXPECT_NEAR(onset_of_instability(f)->frequency,
                pi * std::sqrt(c / paper) * std::sqrt(9.5 / eta), 1e-9);
    // the mean of c with the weights B/(omega^2 + c^2), by hand for two exponentials
    f = memory_flow(eta, slope, {0.3, 0.7}, {43, 600});
    f.instantaneous_viscosity = 9.5;
    const auto onset = onset_of_instability(f);
    const double w2 = onset->frequency * onset->frequency;
    const double slow = 0.3 / (w2 + 43 * 43), fast = 0.7 / (w2 + 600. * 600);
    const double mean = (slow * 43 + fast * 600) / (slow + fast);
    EXPECT_NEAR(onset->reynolds.mean, -pi * pi / (mean * eta * slope), 1e-9);
    EXPECT_LT(mean, 60);
}

TEST(Stability, ErrorOfTheOnsetIsItsScatter)
{
    MemoryFlow f = memory_flow(400, -0.002, {0.6, 0.4}, {40, 200});
    f.viscosity.standard_error = 8;
    f.slope.standard_error = 4e-5;
    f.kernel.terms[0].c.standard_error = 1;
    f.kernel.terms[1].c.standard_error = 10;
    Random random(9);
    double sum = 0, squares = 0;
    constexpr int trials = 4000;
    for (int trial = 0; trial < trials; ++trial) {
        const auto shifted = [&](const Value& v) {  // uniform of the same standard deviation
            return v.mean + random.uniform(-1, 1) * std::sqrt(3) * v.standard_error;
        };
        MemoryFlow g = f;
        g.viscosity.mean = shifted(f.viscosity);
        g.slope.mean = shifted(f.slope);
        for (MemoryTerm& term : g.kernel.terms) term.c.mean = shifted(term.c);
        const double critical = onset_of_instability(g)->reynolds.mean;
        sum += critical;
        squares += critical * critical;
    }
    const double mean = sum / trials, scatter = std::sqrt(squares / trials - mean * mean);
    EXPECT_NEAR(onset_of_instability(f)->reynolds.standard_error / scatter, 1, 0.05);
    f.kernel.terms[0].weight.standard_error = 0.1;
    EXPECT_GT(onset_of_instability(f)->reynolds.standard_error, 1.2 * scatter);
    // one exponential: the relative errors add in squares as in the paper's formula
    const UniformFlow simple{
        .viscosity = {400, 12}, .slope = {-0.002, 0.0002}, .relaxation = {43, 4.3}};
    const MemoryFlow general{.viscosity = simple.viscosity,
                             .slope = simple.slope,
                             .kernel = exponential_kernel(simple.relaxation)};
    EXPECT_NEAR(onset_of_instability(general)->reynolds.standard_error /
                    onset_of_instability(simple)->reynolds.standard_error,
                1, 1e-6);
}

TEST(Stability, LinesOfEqualGrowth)
{
    const MemoryFlow f = memory_flow(400, -0.002, {0.6, 0.4}, {40, 200});
    double before = 0;
    for (double growth : {0., 0.5, 2., 10.}) {
        const auto reynolds = reynolds_of_growth(f, growth);
        ASSERT_TRUE(reynolds);
        EXPECT_NEAR(eigenvalues(f, *reynolds, 1)[0].real(), growth, 1e-6);
        EXPECT_GT(*reynolds, before);
        before = *reynolds;
    }
    EXPECT_FALSE(reynolds_of_growth(f, 1e4));
    EXPECT_FALSE(reynolds_of_growth(memory_flow(20, 0.04, {1}, {43}), 0));
    EXPECT_NEAR(gap_of(reynolds_number(0.005, 400, 30), 0.005, 400), 30, 1e-12);
}

TEST(Stability, RefusesKernelsThatNoSuspensionHas)
{
    // the stress falls at once where the rate is raised
    EXPECT_THROW(growth_rates(memory_flow(400, -0.002, {0.2}, {43}, 0.8), 1), Error);
    MemoryFlow f = memory_flow(400, -0.002, {1}, {43});
    f.instantaneous_viscosity = -1;
    EXPECT_THROW(onset_of_instability(f), Error);
    EXPECT_THROW(onset_of_instability(memory_flow(400, -0.002, {0.5}, {43})), Error);
    EXPECT_THROW(unstable_roots(memory_flow(400, -0.002, {1}, {43}), -1), Error);
    EXPECT_THROW(reynolds_of_growth(memory_flow(400, -0.002, {1}, {43}), -1), Error);
}

}
