#include "engine/one_dimensional_flow.h"

#include "engine/error.h"
#include "engine/exponents.h"
#include "engine/flow_development.h"
#include "engine/stability.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace sigmaflow {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double base_stress = 1.5;  // where this curve falls

// Wyart & Cates: viscosity between two branches with the share exp(-1/s) of frictional contacts
double s_shaped(double s)
{
    const double f = std::exp(-1 / s), jamming = 0.646 * (1 - f) + 0.5815 * f;
    return s * std::pow(1 - 0.578 / jamming, 2);
}

double steady(double stress)
{
    return stress > 0 ? s_shaped(stress * base_stress) / s_shaped(base_stress) : 0;
}

MemoryKernel two_exponentials()
{
    return {.terms = {{{0.6, 0}, {40, 0}}, {{0.4, 0}, {250, 0}}}};
}

/// The linear theory of the base state, whose viscosity is 1.
MemoryFlow linear(const MemoryKernel& kernel)
{
    constexpr double h = 1e-5;
    return {.viscosity = {1, 0},
            .slope = {(steady(1 + h) - steady(1 - h)) / (2 * h), 0},
            .kernel = kernel};
}

struct Case {
    const char* name;
    Constitution constitution;
    MemoryFlow theory;
};

std::vector<Case> cases()
{
    const MemoryKernel one = exponential_kernel({43, 0}), two = two_exponentials();
    MemoryFlow with_hydrodynamics = linear(two);
    with_hydrodynamics.instantaneous_viscosity = 0.1;
    return {{"one exponential", viscous_constitution(steady, one), linear(one)},
            {"two exponentials", viscous_constitution(steady, two), linear(two)},
            {"contact stress", contact_constitution(steady, two, 0.1), with_hydrodynamics}};
}

/// The finite volumes have the wave number 2 n sin(k/2n) instead of k = mode pi.
double reynolds_of_volumes(double reynolds, int mode, int cells)
{
    const double k = mode * pi;
    return reynolds * std::pow(k / (2 * cells * std::sin(k / (2 * cells))), 2);
}

/// Growth and frequency of a small disturbance in the second half of the time.
std::complex<double> measured(const Constitution& constitution, GapEnds ends, double reynolds,
                              int cells, int mode, double time, int steps, int samples)
{
    GapFlow flow = disturbed_flow(constitution, ends, reynolds, cells, mode, 1e-7);
    std::vector<double> series;
    for (int k = 1; k <= steps; ++k) {
        flow = advanced(constitution, flow, time / steps);
        if (k > steps / 2 && k % (steps / samples) == 0)
            series.push_back(mode_amplitude(flow, flow.rate, mode));
    }
    return exponents_of(series, time / samples)[0];
}

/// A time after which only the slowest pair is left, and that it does not leave by more than some
/// powers of ten.
double window(const std::vector<std::complex<double>>& roots)
{
    return std::min(8 / std::abs(roots[0].real()), 3 * 2 * pi / std::abs(roots[0].imag()));
}

double mean(const std::vector<double>& x)
{
    return std::accumulate(x.begin(), x.end(), 0.) / static_cast<double>(x.size());
}

}

TEST(Exponents, OfTwoExponentialsAreExact)
{
    std::vector<double> growing, real;
    for (int k = 0; k < 40; ++k) {
        growing.push_back(3e-8 * std::exp(0.7 * k * 0.1) * std::cos(5 * k * 0.1 + 0.3));
        real.push_back(std::exp(-2. * k * 0.1) - 0.2 * std::exp(-9. * k * 0.1));
    }
    const auto pair = exponents_of(growing, 0.1);
    EXPECT_NEAR(pair[0].real(), 0.7, 1e-10);
    EXPECT_NEAR(std::abs(pair[0].imag()), 5, 1e-10);
    const auto two = exponents_of(real, 0.1);
    EXPECT_NEAR(two[0].real(), -2, 1e-8);
    EXPECT_NEAR(two[1].real(), -9, 1e-6);
    EXPECT_THROW(exponents_of(std::vector<double>{1, 2, 3}, 1), Error);
    EXPECT_THROW(exponents_of(std::vector<double>(5, 0.), 1), Error);
}

TEST(OneDimensionalFlow, GrowthAndFrequencyAreThoseOfTheRootsOnBothSidesOfTheOnset)
{
    for (const Case& c : cases()) {
        const auto onset = onset_of_instability(c.theory);
        ASSERT_TRUE(onset) << c.name;
        for (double factor : {0.7, 0.97, 1.03, 2.}) {
            const double reynolds = factor * onset->reynolds.mean;
            const auto roots = growth_rates(c.theory, reynolds);
            const std::complex<double> x = measured(c.constitution, GapEnds::imposed_stress,
                                                    reynolds, 16, 1, window(roots), 420, 60);
            const double size = std::abs(roots[0]);
            EXPECT_NEAR(x.real(), roots[0].real(), 0.01 * size) << c.name << " " << factor;
            EXPECT_NEAR(std::abs(x.imag()), roots[0].imag(), 0.01 * size)
                << c.name << " " << factor;
            EXPECT_EQ(x.real() > 0, factor > 1) << c.name << " " << factor;
        }
    }
}

TEST(OneDimensionalFlow, PeriodicModesHaveTwiceTheWaveNumber)
{
    const Case c = cases()[1];
    const double reynolds = 3 * 4 * onset_of_instability(c.theory)->reynolds.mean;
    const auto roots = growth_rates(c.theory, reynolds, 2);
    const auto x =
        measured(c.constitution, GapEnds::periodic, reynolds, 16, 1, window(roots), 420, 60);
    EXPECT_NEAR(x.real(), roots[0].real(), 0.02 * std::abs(roots[0]));
    EXPECT_NEAR(std::abs(x.imag()), roots[0].imag(), 0.02 * std::abs(roots[0]));
}

TEST(OneDimensionalFlow, ErrorsFallWithTheSquareOfTheTimeStep)
{
    for (const Case& c : cases()) {
        const double reynolds = 1.5 * onset_of_instability(c.theory)->reynolds.mean;
        constexpr int cells = 8, mode = 1;
        const auto roots = growth_rates(c.theory, reynolds_of_volumes(reynolds, mode, cells), mode);
        const auto error = [&](int steps) {
            const auto x = measured(c.constitution, GapEnds::imposed_stress, reynolds, cells, mode,
                                    window(roots), steps, 20);
            return std::abs(std::complex(x.real(), std::abs(x.imag())) - roots[0]);
        };
        const double coarse = error(200), fine = error(400);
        EXPECT_NEAR(std::log2(coarse / fine), 2, 0.2) << c.name << " " << coarse << " " << fine;
    }
}

TEST(OneDimensionalFlow, ErrorsFallWithTheSquareOfTheCells)
{
    const Case c = cases()[0];
    const double reynolds = 1.5 * onset_of_instability(c.theory)->reynolds.mean;
    const auto roots = growth_rates(c.theory, reynolds, 2);
    const auto error = [&](int cells) {
        const auto x = measured(c.constitution, GapEnds::imposed_rate, reynolds, cells, 2,
                                window(roots), 2400, 20);
        return std::abs(std::complex(x.real(), std::abs(x.imag())) - roots[0]);
    };
    const double coarse = error(8), fine = error(16);
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.2) << coarse << " " << fine;
}

TEST(OneDimensionalFlow, UniformFlowStaysUniform)
{
    for (const Case& c : cases())
        for (GapEnds ends : {GapEnds::imposed_stress, GapEnds::imposed_rate, GapEnds::periodic}) {
            const double reynolds = 2 * onset_of_instability(c.theory)->reynolds.mean;
            GapFlow flow = disturbed_flow(c.constitution, ends, reynolds, 16, 1, 0);
            for (int k = 0; k < 50; ++k) flow = advanced(c.constitution, flow, 0.01);
            EXPECT_NEAR(flow.time, 0.5, 1e-12);
            for (double rate : flow.rate) EXPECT_NEAR(rate, 1, 1e-9) << c.name;
            for (double stress : flow.stress) EXPECT_NEAR(stress, 1, 1e-9) << c.name;
        }
}

// In the large, where rates differ by half. Velocities at the walls belong to half a volume; where
// the stress is imposed the mean momentum stays and the frame is that in which it is 0.
TEST(OneDimensionalFlow, MomentumAndEnergyBalance)
{
    for (const Case& c : cases())
        for (GapEnds ends : {GapEnds::imposed_stress, GapEnds::imposed_rate}) {
            const double reynolds = 5;
            constexpr int cells = 20;
            GapFlow before = disturbed_flow(c.constitution, ends, reynolds, cells, 1, 0.5);
            for (int k = 0; k < 20; ++k) before = advanced(c.constitution, before, 1e-3);
            constexpr double dt = 1e-5;
            const GapFlow now = advanced(c.constitution, before, dt);
            const GapFlow after = advanced(c.constitution, now, dt);
            const auto [low, high] = std::minmax_element(now.stress.begin(), now.stress.end());
            EXPECT_GT(*high - *low, 0.01) << c.name;
            const bool free = ends == GapEnds::imposed_stress;
            const auto share = [](std::size_t f) { return f == 0 || f == cells ? 0.5 : 1.; };
            const auto in_frame = [&](const GapFlow& flow) {
                auto u = velocities(flow);
                double momentum = 0;
                for (std::size_t f = 0; f < u.size(); ++f) momentum += share(f) * u[f] / cells;
                if (free)
                    for (double& one : u) one -= momentum;
                return u;
            };
            const auto u = in_frame(now), u0 = in_frame(before), u1 = in_frame(after);
            double momentum = 0, energy = 0, dissipation = 0;  // their changes per time
            for (std::size_t f = 0; f < u.size(); ++f) {
                momentum += reynolds * share(f) * (u1[f] - u0[f]) / (2 * dt) / cells;
                energy += reynolds * share(f) * (u1[f] * u1[f] - u0[f] * u0[f]) / (4 * dt) / cells;
            }
            for (std::size_t j = 0; j < now.rate.size(); ++j)
                dissipation += now.stress[j] * now.rate[j] / cells;
            const double above = free ? 1 : now.stress.back();
            const double below = free ? 1 : now.stress.front();
            const double scale = std::abs(energy) + 0.1 * dissipation;
            EXPECT_NEAR(momentum, above - below, 2e-3) << c.name;
            EXPECT_NEAR(energy, u.back() * above - u.front() * below - dissipation, 2e-3 * scale)
                << c.name;
            if (!free) {
                EXPECT_NEAR(mean(after.rate), 1, 1e-12) << c.name;
            }
        }
}

TEST(OneDimensionalFlow, AtAnImposedRateUniformFlowLeavesTheFallingBranchAsAWhole)
{
    for (const Case& c : cases()) {
        const double growth = growth_at_imposed_rate(c.theory);
        EXPECT_GT(growth, 0);
        GapFlow flow = disturbed_flow(c.constitution, GapEnds::imposed_rate, 0.01, 4, 1, 0);
        for (auto& part : flow.parts)
            for (double& s : part) s += 1e-7;
        std::vector<double> deviation;
        const double time = 6 / growth;
        for (int k = 0; k < 600; ++k) {
            flow = advanced(c.constitution, flow, time / 600);
            if (k >= 400) deviation.push_back(flow.stress[0] - 1);
        }
        EXPECT_NEAR(std::log(deviation.back() / deviation.front()) / (199 * time / 600) / growth, 1,
                    0.01)
            << c.name;
    }
    // -b c for one exponential
    const MemoryFlow one = cases()[0].theory;
    EXPECT_NEAR(growth_at_imposed_rate(one), -43 * one.slope.mean, 1e-10);
}

TEST(FlowDevelopment, FollowsADisturbanceToItsEnd)
{
    for (std::size_t reading : {0u, 2u}) {
        const Case c = cases()[reading];
        const double critical = onset_of_instability(c.theory)->reynolds.mean;
        DevelopmentPlan plan = plan_development(c.theory, 0.8 * critical, 1e-4);
        plan.cells = 8;
        const Development stable = develop(c.constitution, c.theory, plan);
        EXPECT_EQ(stable.fate, Fate::decays) << c.name;
        ASSERT_TRUE(stable.measured) << c.name;
        EXPECT_LT(stable.measured->real(), 0);
        EXPECT_NEAR(std::abs(*stable.measured - stable.expected), 0,
                    0.02 * std::abs(stable.expected))
            << c.name;
        plan = plan_development(c.theory, 1.5 * critical, 1e-4);
        plan.cells = 8;
        const Development unstable = develop(c.constitution, c.theory, plan);
        EXPECT_FALSE(unstable.broke_off) << c.name;
        EXPECT_EQ(unstable.fate, Fate::oscillates) << c.name;
        EXPECT_GT(unstable.largest_rate, 1.01) << c.name;
        // not far above the onset the frequency is close to the linear one
        EXPECT_NEAR(unstable.frequency / unstable.expected.imag(), 1, 0.5) << c.name;
    }
    // far above it the first two roots are real
    const Case c = cases()[0];
    const double reynolds = 100 * onset_of_instability(c.theory)->reynolds.mean;
    DevelopmentPlan plan = plan_development(c.theory, reynolds, 1e-6);
    plan.cells = 8;
    plan.time = 5 / growth_rates(c.theory, reynolds)[0].real();
    const Development overdamped = develop(c.constitution, c.theory, plan);
    ASSERT_TRUE(overdamped.measured);
    EXPECT_NEAR(overdamped.measured->real() / overdamped.expected.real(), 1, 0.02);
    EXPECT_NEAR(overdamped.measured->imag(), 0, 1e-6);
    EXPECT_THROW(plan_development(c.theory, reynolds, 0), Error);
}

// Each of the two readings at an imposed stress, against the linear answer of its kernel.
TEST(Constitution, AnswersASmallStepInStressAsTheKernelSays)
{
    constexpr double step = 1e-5;
    for (const Case& c : cases()) {
        const double slope = c.theory.slope.mean;
        const double sudden = 1 / instantaneous_viscosity(c.theory);
        std::vector<double> parts(c.constitution.c.size(), c.constitution.target(1));
        const double stress = 1 + step, target = c.constitution.target(stress);
        constexpr double strain = 0.01;
        double s = 0, kept = 0;
        for (std::size_t i = 0; i < parts.size(); ++i) {
            const double left = std::exp(-c.constitution.c[i] * strain);
            s += c.constitution.shares[i] * (target + (parts[i] - target) * left);
            kept += c.constitution.shares[i] * left;
        }
        double low = 0, high = 10;  // the rate
        for (int k = 0; k < 100; ++k) {
            const double middle = (low + high) / 2;
            (c.constitution.stress(middle, s) > stress ? high : low) = middle;
        }
        EXPECT_NEAR((low - 1) / step, slope + (sudden - slope) * kept, 1e-3) << c.name;
    }
}

TEST(Constitution, RefusesAnInstantaneousPartInTheViscousReading)
{
    const MemoryKernel kernel{.terms = {{{1.5, 0}, {40, 0}}}, .instantaneous = -0.5};
    EXPECT_THROW(viscous_constitution(steady, kernel), Error);
    EXPECT_NO_THROW(contact_constitution(steady, kernel, 0.1));
    EXPECT_THROW(contact_constitution(steady, kernel, 0), Error);
    EXPECT_THROW(disturbed_flow(cases()[0].constitution, GapEnds::imposed_rate, 0, 8, 1, 0), Error);
    EXPECT_THROW(disturbed_flow(cases()[0].constitution, GapEnds::imposed_rate, 1, 3, 1, 0), Error);
}

TEST(SteadyCurve, PassesItsPointsAndHasNoOtherExtremes)
{
    const std::vector<double> stresses{0.3, 0.5, 0.7, 1, 1.5, 2, 3, 5, 10, 20};
    std::vector<FlowPoint> points;
    for (double s : stresses) points.push_back({s, s_shaped(s), 0, false});
    const SteadyCurve curve = steady_curve(points);
    for (double s : stresses) EXPECT_NEAR(curve.shear_rate(s) / s_shaped(s), 1, 1e-12);
    for (std::size_t k = 0; k + 1 < stresses.size(); ++k) {
        const double a = s_shaped(stresses[k]), b = s_shaped(stresses[k + 1]);
        double before = a;
        for (int i = 1; i <= 20; ++i) {
            const double s = stresses[k] + (stresses[k + 1] - stresses[k]) * i / 20;
            const double rate = curve.shear_rate(s);
            EXPECT_GE((rate - before) * (b - a), -1e-15) << s;
            before = rate;
        }
    }
    for (double s : {0.1, 0.4, 0.9, 1.2, 7., 50.}) {
        const double h = 1e-6 * s;
        const double slope = (curve.shear_rate(s + h) - curve.shear_rate(s - h)) / (2 * h);
        EXPECT_NEAR(curve.slope(s), slope, 1e-5 * std::abs(slope)) << s;
    }
    EXPECT_NEAR(curve.shear_rate(1.25) / s_shaped(1.25), 1, 0.03);  // between points
    EXPECT_NEAR(curve.shear_rate(0.03), 0.1 * s_shaped(0.3), 1e-15);
    EXPECT_EQ(curve.shear_rate(0), 0);
}

TEST(SteadyCurve, FallsMostSteeplyWhereTheCriticalReynoldsNumberIsSmallest)
{
    std::vector<FlowPoint> points;
    for (double s : {0.3, 0.5, 0.7, 1., 1.5, 2., 3., 5., 10.})
        points.push_back({s, s_shaped(s), 0, false});
    const SteadyCurve curve = steady_curve(points);
    const auto critical = [&](double s) {
        const MemoryFlow flow{.viscosity = {s / curve.shear_rate(s), 0},
                              .slope = {curve.slope(s), 0},
                              .kernel = two_exponentials()};
        const auto onset = onset_of_instability(flow);
        return onset ? onset->reynolds.mean : 1e300;
    };
    const double steepest = curve.steepest_fall(0.3, 10);
    for (double s = 0.35; s < 10; s *= 1.05) EXPECT_LE(critical(steepest), 1.001 * critical(s));
}

TEST(SteadyCurve, EndsWhereItJams)
{
    const std::vector<FlowPoint> points{
        {4, 0, 0, true}, {1, 2, 0, false}, {2, 1, 0, false}, {8, 3, 0, false}};
    const SteadyCurve curve = steady_curve(points);
    EXPECT_TRUE(curve.jams);
    EXPECT_EQ(curve.shear_rate(4), 0);
    EXPECT_EQ(curve.shear_rate(6), 0);
    EXPECT_GT(curve.shear_rate(3.9), 0);
    EXPECT_NEAR(over_base(curve, 2)(0.5), 2, 1e-12);
    EXPECT_THROW(over_base(curve, 5), Error);
    EXPECT_THROW(steady_curve(std::vector<FlowPoint>{{1, 1, 0, false}}), Error);
    EXPECT_THROW(steady_curve(std::vector<FlowPoint>{{1, 1, 0, false}, {2, 0, 0, true}}), Error);
}

}
