// Oracles: the sum of all terms is the input; energies of springs and repulsion before and after a
// short step; a pair whose powers are known.
#include "engine/power_balance.h"

#include "engine/step.h"
#include "tests/support/random_state.h"

#include <gtest/gtest.h>
#include <cmath>

namespace sigmaflow {

namespace {

const SolverSettings exact{SolverKind::cholesky};

State thickened(const Model& model, const Control& control, unsigned seed)
{
    State s = support::dense_state(80, 0.56, 0.3, seed);
    Workspace workspace(exact);
    for (int k = 0; k < 60; ++k) advance(s, model, control, {Scheme::euler, 5e-3}, {}, workspace);
    return s;
}

struct Energies {
    double normal = 0, tangential = 0, repulsion = 0;
};

/// From positions and springs alone, with the formulas of potentials.
Energies energies(const State& s, const Model& m, const Control& control)
{
    const Stiffness k = stiffness(m, control);
    Energies result;
    NeighbourList list;
    list.update(s, m.repulsion_range);
    for (const Pair& pair : find_pairs(s, m.repulsion_range, list)) {
        const double a = s.radius[pair.i], b = s.radius[pair.j];
        const double force = reference_force * m.repulsion * a * b / (a + b);
        const double h = pair.gap, length = m.debye_length;
        result.repulsion += h > 0 ? force * length * std::exp(-h / length) : force * (length - h);
        if (h < 0) result.normal += reference_force * k.normal * (a + b) / 2 * h * h / 2;
    }
    for (const Contact& c : s.contacts) {
        const double mean = (s.radius[c.i] + s.radius[c.j]) / 2;
        result.tangential +=
            reference_force * mean *
            (k.tangential * c.spring.squaredNorm() + k.rolling * c.rolling.squaredNorm()) / 2;
    }
    return result;
}

struct Variant {
    const char* name;
    Model model;
};

std::vector<Variant> variants()
{
    Model dashpot, slippery, rolling, no_friction;
    dashpot.contact_hydrodynamics = ContactHydrodynamics::dashpot;
    slippery.friction_static = slippery.friction_dynamic = 0.1;
    rolling.rolling_stiffness = 30;
    rolling.rolling_friction = 0.02;
    no_friction.friction_static = no_friction.friction_dynamic = 0;
    return {{"default", {}},
            {"dashpot", dashpot},
            {"slippery", slippery},
            {"rolling", rolling},
            {"no_friction", no_friction}};
}

}

class PowerOf : public testing::TestWithParam<Variant> {};

TEST_P(PowerOf, AllTermsAddUpToTheInputAndFrictionOnlyDissipates)
{
    const auto& [name, model] = GetParam();
    const ImposedStress stress{3};
    const State s = thickened(model, stress, 1);
    Workspace workspace(exact);
    const Power p = evaluate_power(s, model, stress, workspace);
    EXPECT_LT(std::abs(p.residual), 1e-9);
    EXPECT_NEAR(p.input, 3 * p.shear_rate * s.box.volume(), 1e-9 * std::abs(p.input));
    for (const PowerField& field : power_fields())
        if (!field.stored) {
            EXPECT_GE(p.*field.value, 0) << field.name;
        }
    EXPECT_EQ(p.sliding > 0, model.friction_static > 0);
    EXPECT_EQ(p.dashpots > 0, model.contact_hydrodynamics == ContactHydrodynamics::dashpot);
    const auto d = evaluate_in_detail(s, model, stress, workspace);
    EXPECT_NEAR(p.normal_springs + p.tangential_springs + p.sliding, power_balance(s, d).contact,
                1e-9 * std::abs(p.input));
}

// The error of a difference over a step is proportional to it.
TEST_P(PowerOf, SpringsAndRepulsionGainWhatIsStored)
{
    const auto& [name, model] = GetParam();
    const ImposedStress stress{3};
    State before = thickened(model, stress, 2);
    Workspace workspace(exact);
    // springs are cut to the friction limit of the evaluated state
    const Evaluation e = evaluate(before, model, stress, workspace);
    ASSERT_EQ(before.contacts.size(), e.contacts.size());
    for (std::size_t c = 0; c < e.contacts.size(); ++c) before.contacts[c] = e.contacts[c].memory;
    const Power p = evaluate_power(before, model, stress, workspace);
    const Energies was = energies(before, model, stress);
    double error[2];
    for (int k = 0; k < 2; ++k) {
        State after = before;
        advance(after, model, stress, {Scheme::euler, k == 0 ? 2e-7 : 1e-7}, {}, workspace);
        const double time = after.time - before.time;
        ASSERT_GT(time, 0);
        const Energies is = energies(after, model, stress);
        const double normal = (is.normal - was.normal) / time - p.normal_springs;
        const double tangential = (is.tangential - was.tangential) / time - p.tangential_springs;
        const double repulsion = (is.repulsion - was.repulsion) / time - p.repulsion;
        EXPECT_LT(std::abs(normal), 1e-3 * std::abs(p.input));
        EXPECT_LT(std::abs(tangential), 1e-3 * std::abs(p.input));
        EXPECT_LT(std::abs(repulsion), 1e-3 * std::abs(p.input));
        error[k] = std::abs(normal) + std::abs(tangential) + std::abs(repulsion);
    }
    EXPECT_LT(error[1], 0.7 * error[0]);
    EXPECT_GT(std::abs(p.normal_springs), 0.01 * std::abs(p.input));
}

INSTANTIATE_TEST_SUITE_P(Variants, PowerOf, testing::ValuesIn(variants()),
                         [](const auto& variant) { return std::string(variant.param.name); });

// Two spheres pressed together, one moves along their common tangent plane at 0.1 a rate0.
TEST(ContactPower, OfABlockThatSlidesIsFrictionTimesSpeed)
{
    State s;
    s.box.length = {20, 20, 20};
    s.position = {Vec3(5, 5, 5), Vec3(5, 5, 6.99)};
    s.radius = {1, 1};
    Model model;
    model.stiffness_scale = StiffnessScale::fixed;
    model.friction_static = model.friction_dynamic = 0.4;
    const Control control = ImposedRate{0};
    const auto power = [&](const Vec3& spring, const Vec3& velocity) {
        const Pair pair{0, 1, 0, Vec3(0, 0, 1.99), Vec3(0, 0, 1), 1.99, -0.01, -0.01};
        Evaluation e;
        e.model = model;
        e.control = control;
        e.nonaffine.assign(2, Vec6::Zero());
        e.nonaffine[1].head<3>() = velocity;
        e.contacts = {contact_load(pair, 1, 1, {0, 1, spring}, model, stiffness(model, control))};
        e.motion = {{Vec3(velocity.x(), velocity.y(), 0), Vec3::Zero()}};
        return contact_power(s, e);
    };
    // N = 2000/(6 pi) F*/a times 0.01 a = 20 in eta0 rate0 a^2, limit 8
    const Vec3 loaded(1, 0, 0), along(0.1, 0, 0);
    const ContactPower slides = power(loaded, along);
    EXPECT_NEAR(slides.sliding, 8 * 0.1, 1e-9);
    EXPECT_NEAR(slides.tangential_springs, 0, 1e-12);
    const ContactPower sticks = power(0.005 * loaded, along);  // 5 < 8
    EXPECT_NEAR(sticks.tangential_springs, 5 * 0.1, 1e-9);
    EXPECT_EQ(sticks.sliding, 0);
    const ContactPower turns_back = power(loaded, -along);  // springs give back
    EXPECT_NEAR(turns_back.tangential_springs, -8 * 0.1, 1e-9);
    EXPECT_EQ(turns_back.sliding, 0);
    // opening at 0.01: N falls by 20 per unit time, the limit by 8: 8 * 8/1000 is set free and lost
    const ContactPower opens = power(loaded, Vec3(0, 0, 0.01));
    EXPECT_NEAR(opens.normal_springs, -20 * 0.01, 1e-9);
    EXPECT_NEAR(opens.tangential_springs, -8 * 8 / 1000., 1e-9);
    EXPECT_NEAR(opens.sliding, 8 * 8 / 1000., 1e-9);
}

TEST(EvaluatePower, UnderAnImposedRateBalancesToo)
{
    Model fixed;
    fixed.stiffness_scale = StiffnessScale::fixed;
    const State s = thickened(fixed, ImposedRate{0.1}, 3);
    Workspace workspace(exact);
    for (const double rate : {0.1, -0.1, 0.0}) {
        const Power p = evaluate_power(s, fixed, ImposedRate{rate}, workspace);
        EXPECT_LT(std::abs(p.residual), 1e-9) << rate;
        EXPECT_EQ(p.shear_rate, rate);
    }
}

}
