#include "engine/step.h"

#include "engine/error.h"
#include "tests/support/random_state.h"

#include <gtest/gtest.h>
#include <algorithm>
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
            EXPECT_LT(std::abs(c.memory.spring.dot(c.pair.normal)), 1e-14);
            sliding += c.memory.sliding;
        }
        advance(s, m, ImposedStress{5}, {Scheme::heun, 4e-3}, {}, workspace, &e);
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
            advance(s, m, control, {}, {target, 1e9}, workspace);
            ASSERT_LT(++steps, 1000);
        }
        EXPECT_NEAR(s.strain, target, 1e-13);
    }
    const double end = s.time + 0.005;
    while (s.time < end - 1e-12) advance(s, m, control, {}, {1e9, end}, workspace);
    EXPECT_NEAR(s.time, end, 1e-13);
}

TEST(Step, TwoRunsFromOneStateAreIdentical)
{
    const State start = support::dense_state(50, 0.56, 0.2, 4);
    const auto end = [&] {
        State s = start;
        Workspace workspace;
        for (int k = 0; k < 40; ++k) advance(s, {}, ImposedStress{2}, {}, {}, workspace);
        return s;
    };
    const State one = end(), two = end();
    EXPECT_EQ(one.position, two.position);
    EXPECT_EQ(one.time, two.time);
}

class Threads : public testing::TestWithParam<Scheme> {};

// bit by bit: sums have one order, whoever forms them
TEST_P(Threads, GiveTheSameMotion)
{
    const State start = support::dense_state(300, 0.56, 0.2, 4);
    const auto end = [&](int threads) {
        State s = start;
        Workspace workspace({SolverKind::pcg, 1e-4, threads});
        for (int k = 0; k < 40; ++k)
            advance(s, {}, ImposedStress{2}, {GetParam(), 4e-3}, {}, workspace);
        return s;
    };
    const State one = end(1);
    ASSERT_GT(one.contacts.size(), 30u);
    for (int threads : {2, 3}) {
        const State several = end(threads);
        EXPECT_EQ(one.position, several.position);
        EXPECT_EQ(one.time, several.time);
        EXPECT_EQ(one.strain, several.strain);
        ASSERT_EQ(one.contacts.size(), several.contacts.size());
        for (std::size_t k = 0; k < one.contacts.size(); ++k)
            EXPECT_EQ(one.contacts[k].spring, several.contacts[k].spring);
    }
}

INSTANTIATE_TEST_SUITE_P(Schemes, Threads, testing::Values(Scheme::heun, Scheme::implicit),
                         [](const auto& scheme) {
                             return scheme.param == Scheme::heun ? "heun" : "implicit";
                         });

TEST(Step, AReversedRateTakesTheBoxBack)
{
    State s = dilute_state();
    const State end = run(s, Scheme::heun, March::time, 0.1, 10, ImposedRate{-1});
    EXPECT_NEAR(end.strain, -0.1, 1e-12);
    EXPECT_NEAR(end.box.offset, 3 - 0.1 * 14, 1e-12);
}

namespace {

// Four spheres in a sheared chain of loaded, sticking contacts: stiff but smooth.
State chain_of_contacts()
{
    State s;
    s.box = {Vec3(12, 12, 12), 2};
    s.position = {Vec3(3, 4, 6), Vec3(4.7, 5.02, 6.1), Vec3(6.9, 5.9, 6), Vec3(8.45, 7.1, 6.2)};
    s.radius = {1, 1, 1.4, 0.6};
    return s;
}

Model sticking_model(double stiffness)
{
    Model m;
    m.stiffness_scale = StiffnessScale::fixed;
    m.normal_stiffness = stiffness;
    m.tangential_stiffness = stiffness / 2;
    m.friction_static = m.friction_dynamic = 1e6;
    m.repulsion = 0;
    return m;
}

State run_implicitly(State s, const Model& m, double time, int steps, int* contacts)
{
    Workspace workspace(exact);
    for (int k = 0; k < steps; ++k) {
        const Evaluation e = implicit_step(s, m, ImposedStress{2}, time / steps, 1e9, workspace);
        if (contacts) *contacts = std::min(*contacts, static_cast<int>(e.contacts.size()));
    }
    return s;
}

}

TEST(ImplicitStep, IsOfSecondOrderForSmoothMotionWithLoadedContacts)
{
    const Model m = sticking_model(20);
    int contacts = 99;
    // the fast start is left behind before the order is measured
    const State start = run_implicitly(chain_of_contacts(), m, 0.02, 400, &contacts);
    const auto at = [&](int steps) { return run_implicitly(start, m, 0.02, steps, &contacts); };
    const State coarse = at(8), middle = at(16), fine = at(32);
    ASSERT_EQ(contacts, 3);  // no contact opens or closes on the way
    EXPECT_NEAR(std::log2(distance(coarse, middle) / distance(middle, fine)), 2, 0.3);
}

TEST(ImplicitStep, ConvergesToTheSameMotionAsHeun)
{
    const Model m = sticking_model(20);
    const State start = chain_of_contacts();
    const State implicit = run_implicitly(start, m, 0.02, 3200, nullptr);
    State heun = start;
    Workspace workspace(exact);
    for (int k = 0; k < 3200; ++k)
        step(heun, m, ImposedStress{2}, Scheme::heun, March::time, 0.02 / 3200,
             evaluate(heun, m, ImposedStress{2}, workspace), workspace);
    EXPECT_LT(distance(implicit, heun), 2e-6);
    EXPECT_GT(distance(start, heun), 0.01);
    for (std::size_t k = 0; k < 3; ++k)
        EXPECT_LT((implicit.contacts.at(k).spring - heun.contacts.at(k).spring).norm(), 1e-6);
}

TEST(ImplicitStep, StaysStableForSpringsAThousandTimesTooStiffForTheStep)
{
    const Model m = sticking_model(3e6);
    State s = chain_of_contacts();
    Workspace workspace;
    const double dt = 1e-3;
    Evaluation e = evaluate(s, m, ImposedStress{2}, workspace);
    ASSERT_LT(1000 * stable_time_step(e), dt);
    double before = 0;
    for (int k = 0; k < 60; ++k) {
        e = implicit_step(s, m, ImposedStress{2}, dt, 1e9, workspace);
        if (k > 40) {  // an unstable spring would turn the rate round at every step
            EXPECT_GT(e.shear_rate / before, 0.8);
            EXPECT_LT(e.shear_rate / before, 1.25);
        }
        before = e.shear_rate;
    }
}

TEST(ImplicitStep, AdaptiveStepsLandOnLimitsExactly)
{
    State s = support::dense_state(50, 0.55, 0.2, 4);
    const Model m;
    Workspace workspace;
    int steps = 0;
    for (int output = 1; output <= 10; ++output) {
        while (s.strain < 0.01 * output - 1e-12) {
            advance(s, m, ImposedStress{5}, {Scheme::implicit, 5e-3}, {0.01 * output, 1e9},
                    workspace);
            ASSERT_LT(++steps, 3000);
        }
        EXPECT_NEAR(s.strain, 0.01 * output, 1e-12);
    }
    EXPECT_LT(steps, 400);  // Heun takes over a thousand
}

// The time that the same strain takes, from the same state: the friction makes both schemes of
// first order with a small coefficient.
TEST(ImplicitStep, GivesTheRateOfHeunInAFrictionalSuspension)
{
    State start = support::dense_state(60, 0.52, 0.2, 4);
    const Model m;
    const Control control = ImposedStress{5};
    Workspace first;
    while (start.strain < 0.15)
        advance(start, m, control, {Scheme::implicit, 2e-3}, {0.15, 1e9}, first);
    const auto duration = [&](Scheme scheme, double displacement) {
        State s = start;
        Workspace workspace({SolverKind::pcg, 1e-6});
        while (s.strain < 0.2 - 1e-12)
            advance(s, m, control, {scheme, displacement}, {0.2, 1e9}, workspace);
        return s.time - start.time;
    };
    const double heun = duration(Scheme::heun, 5e-4);
    EXPECT_NEAR(duration(Scheme::implicit, 1e-3) / heun, 1, 0.003);
    EXPECT_NEAR(duration(Scheme::implicit, 1e-2) / heun, 1, 0.01);
}

// A step that moves too far is undone: what it left behind must not show.
TEST(ImplicitStep, AnUndoneStepLeavesNoTrace)
{
    const State start = support::dense_state(60, 0.55, 0.2, 4);
    const auto end = [&](bool disturbed) {
        State s = start;
        Workspace workspace(exact);
        for (int k = 0; k < 20; ++k) {
            if (disturbed && k == 10) {
                State undone = s;
                implicit_step(undone, {}, ImposedStress{5}, 3e-3, 1e9, workspace);
            }
            implicit_step(s, {}, ImposedStress{5}, 1e-3, 1e9, workspace);
        }
        return s;
    };
    // the guess of the velocities may have changed, at the order of the error of the step
    EXPECT_LT(distance(end(true), end(false)), 1e-5);
}

TEST(ImplicitStep, RefusesTheDashpotVariant)
{
    State s = chain_of_contacts();
    Model m;
    m.contact_hydrodynamics = ContactHydrodynamics::dashpot;
    Workspace workspace;
    EXPECT_THROW(implicit_step(s, m, ImposedStress{2}, 1e-3, 1e9, workspace), Error);
}

}
