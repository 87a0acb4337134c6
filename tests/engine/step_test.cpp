#include "engine/step.h"

#include "tests/support/random_state.h"

#include <gtest/gtest.h>
#include <cmath>

namespace sigmaflow {

using support::Random;

namespace {

const SolverSettings exact{SolverKind::cholesky};

// Few spheres that stay apart: every force is smooth.
State dilute_state()
{
    State s;
    s.box = {Vec3(14, 14, 14), 3};
    s.position = {Vec3(2, 5, 7), Vec3(4.15, 5.6, 7.1), Vec3(4.4, 8.3, 7.2), Vec3(1, 13.6, 3)};
    s.position.push_back(Vec3(1.3 - 3 + 14, 0.7 + 1, 3.4));
    s.radius = {1, 1, 1.4, 1, 1};
    return s;
}

State run(State s, Scheme scheme, March march, double end, int steps, const Control& control)
{
    Model m;
    m.debye_length = 0.2;
    m.lubrication_range = 0.9;
    m.repulsion_range = 0.9;
    m.stiffness_scale = StiffnessScale::fixed;
    Workspace workspace(exact);
    for (int k = 0; k < steps; ++k)
        step(s, m, control, scheme, march, end / steps, evaluate(s, m, control, workspace),
             workspace);
    return s;
}

double distance(const State& a, const State& b)
{
    double square = 0;
    for (int i = 0; i < a.size(); ++i)
        square += separation(a.box, a.position[i], b.position[i]).d.squaredNorm();
    return std::sqrt(square);
}

double order(Scheme scheme, March march, const Control& control)
{
    const State start = dilute_state();
    const auto at = [&](int steps) { return run(start, scheme, march, 0.1, steps, control); };
    const State coarse = at(8), middle = at(16), fine = at(32);
    return std::log2(distance(coarse, middle) / distance(middle, fine));
}

}

TEST(Step, HeunIsOfSecondOrderWhereTheForcesAreSmooth)
{
    EXPECT_NEAR(order(Scheme::heun, March::strain, ImposedStress{2}), 2, 0.15);
    EXPECT_NEAR(order(Scheme::heun, March::time, ImposedStress{2}), 2, 0.15);
    EXPECT_NEAR(order(Scheme::heun, March::time, ImposedRate{1}), 2, 0.15);
}

TEST(Step, EulerIsOfFirstOrder)
{
    EXPECT_NEAR(order(Scheme::euler, March::strain, ImposedStress{2}), 1, 0.15);
}

TEST(Step, BoxAndStrainMoveTogether)
{
    const State end = run(dilute_state(), Scheme::heun, March::time, 0.5, 20, ImposedStress{2});
    const double expected = 3 + end.strain * 14;
    EXPECT_NEAR(std::remainder(end.box.offset - expected, 14), 0, 1e-12);
    EXPECT_NEAR(end.time, 0.5, 1e-12);
}

TEST(Step, AConstantSlipStretchesTheSpringByTheDistanceSlid)
{
    // two spheres in a strong squeeze, turned as a gear against each other: the contact sticks
    State s;
    s.box.length = Vec3(12, 12, 12);
    s.position = {Vec3(5, 5, 5), Vec3(6.98, 5, 5)};
    s.radius = {1, 1};
    s.contacts = {{0, 1, Vec3(0, 1e-6, 0), Vec3::Zero(), false}};
    Model m;
    m.stiffness_scale = StiffnessScale::fixed;
    m.friction_static = m.friction_dynamic = 1e6;
    Workspace workspace(exact);
    const Control control = ImposedRate{0.05};
    const Evaluation e = evaluate(s, m, control, workspace);
    ASSERT_EQ(e.contacts.size(), 1u);
    const double h = 1e-5;
    const Vec3 expected = s.contacts[0].spring + h * e.motion[0].slip;
    step(s, m, control, Scheme::heun, March::time, h, e, workspace);
    EXPECT_LT((s.contacts.at(0).spring - expected).norm(), 1e-3 * h * e.motion[0].slip.norm());
}

TEST(Step, FrictionNeverExceedsTheCoulombLimit)
{
    State s = support::dense_state(50, 0.56, 0.2, 4);
    Model m;
    m.friction_static = 0.5;
    m.friction_dynamic = 0.3;
    Workspace workspace;
    int sliding = 0;
    for (int k = 0; k < 150; ++k) {
        const Evaluation e = evaluate(s, m, ImposedStress{5}, workspace);
        for (const ContactLoad& c : e.contacts) {
            const double mu = c.memory.sliding ? 0.3 : 0.5;
            EXPECT_LE(c.friction.norm(), mu * c.load * (1 + 1e-9));
            EXPECT_LT(std::abs(c.memory.spring.dot(e.pairs[c.pair].pair.normal)), 1e-14);
            sliding += c.memory.sliding;
        }
        advance(s, m, ImposedStress{5}, {Scheme::heun, 4e-3}, {}, e, workspace);
    }
    EXPECT_GT(sliding, 0);
}

TEST(Step, AdaptiveStepsLandOnLimitsExactly)
{
    State s = support::dense_state(50, 0.5, 0.2, 4);
    const Model m;
    const Control control = ImposedStress{5};
    Workspace workspace;
    for (int output = 1; output <= 5; ++output) {
        const double target = 0.003 * output;
        int steps = 0;
        while (s.strain < target - 1e-12) {
            advance(s, m, control, {}, {target, 1e9}, evaluate(s, m, control, workspace),
                    workspace);
            ASSERT_LT(++steps, 1000);
        }
        EXPECT_NEAR(s.strain, target, 1e-13);
    }
    const double end = s.time + 0.005;
    while (s.time < end - 1e-12)
        advance(s, m, control, {}, {1e9, end}, evaluate(s, m, control, workspace), workspace);
    EXPECT_NEAR(s.time, end, 1e-13);
}

TEST(Step, TwoRunsFromOneStateAreIdentical)
{
    const State start = support::dense_state(50, 0.56, 0.2, 4);
    const auto end = [&] {
        State s = start;
        Workspace workspace;
        for (int k = 0; k < 40; ++k)
            advance(s, {}, ImposedStress{2}, {}, {}, evaluate(s, {}, ImposedStress{2}, workspace),
                    workspace);
        return s;
    };
    const State one = end(), two = end();
    EXPECT_EQ(one.position, two.position);
    EXPECT_EQ(one.time, two.time);
}

TEST(Step, AReversedRateTakesTheBoxBack)
{
    State s = dilute_state();
    const State end = run(s, Scheme::heun, March::time, 0.1, 10, ImposedRate{-1});
    EXPECT_NEAR(end.strain, -0.1, 1e-12);
    EXPECT_NEAR(end.box.offset, 3 - 0.1 * 14, 1e-12);
}

}
