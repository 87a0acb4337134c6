#include "engine/evaluation.h"

#include "engine/error.h"
#include "engine/power_balance.h"
#include "engine/step.h"
#include "engine/workspace.h"
#include "tests/support/random_state.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <numeric>

namespace sigmaflow {

using support::Random;

namespace {

const SolverSettings exact{SolverKind::cholesky};

/// A state with gaps, loaded contacts and springs at a sheared boundary.
State frictional_state(int n = 80, unsigned seed = 3)
{
    State s = support::dense_state(n, 0.55, 0.3, seed);
    Random random(seed);
    for (Vec3& x : s.position) x += 0.01 * random.vector();
    Workspace workspace(exact);
    const Model model;
    for (int k = 0; k < 30; ++k)
        advance(s, model, ImposedStress{5}, {Scheme::euler, 5e-3}, {}, workspace);
    return s;
}

/// Every variant of the model under stress or rate control that the solver must handle.
struct Variant {
    const char* name;
    Model model;
    Control control;
};

std::vector<Variant> variants()
{
    Model dashpot, no_drag, no_friction, fixed, no_einstein, relaxation;
    dashpot.contact_hydrodynamics = ContactHydrodynamics::dashpot;
    no_drag.background_drag = false;
    no_friction.friction_static = no_friction.friction_dynamic = 0;
    fixed.stiffness_scale = StiffnessScale::fixed;
    no_einstein.einstein = false;
    relaxation = dashpot;
    relaxation.contact_relaxation_time = 1e-3;
    return {{"default", {}, ImposedStress{5}},
            {"dashpot", dashpot, ImposedStress{5}},
            {"no_drag", no_drag, ImposedStress{5}},
            {"no_friction", no_friction, ImposedStress{5}},
            {"no_einstein", no_einstein, ImposedStress{5}},
            {"relaxation_time", relaxation, ImposedStress{5}},
            {"fixed_stiffness", fixed, ImposedStress{0.5}},
            {"rate", fixed, ImposedRate{0.1}},
            {"negative_rate", fixed, ImposedRate{-0.1}}};
}

double largest_difference(const Velocities& u, const Velocities& v)
{
    double difference = 0, size = 0;
    for (std::size_t i = 0; i < u.size(); ++i) {
        difference = std::max(difference, (u[i] - v[i]).cwiseAbs().maxCoeff());
        size = std::max(size, u[i].cwiseAbs().maxCoeff());
    }
    return difference / size;
}

State single_sphere(double radius, double box)
{
    State s;
    s.box.length = Vec3(box, box, box);
    s.position = {Vec3(1, 2, 3)};
    s.radius = {radius};
    return s;
}

}

class EveryVariant : public testing::TestWithParam<Variant> {};

TEST_P(EveryVariant, TheStressIsTheImposedOneAndThePowerBalances)
{
    const State s = frictional_state();
    Workspace workspace(exact);
    const auto& [name, model, control] = GetParam();
    const DetailedEvaluation d = evaluate_in_detail(s, model, control, workspace);
    ASSERT_GT(d.evaluation.contacts.size(), 10u);
    if (const auto* stress = std::get_if<ImposedStress>(&control)) {
        EXPECT_NEAR(d.total_stress()(flow, gradient) / stress->value, 1, 1e-10);
    }
    const PowerBalance p = power_balance(s, d);
    const double sum = p.solvent + p.drag + p.lubrication + p.dashpot + p.contact + p.repulsion +
                       p.torque_residual;
    EXPECT_NEAR(sum / p.input, 1, 1e-10);
    Mat3 particles = Mat3::Zero();
    for (const Mat3& S : particle_stress(s, d)) particles += S;
    particles /= s.box.volume();
    particles(0, 1) += d.evaluation.shear_rate;
    particles(1, 0) += d.evaluation.shear_rate;
    EXPECT_LT((particles - d.total_stress()).norm(), 1e-11 * d.total_stress().norm());
}

// The stress recomputed from the velocities alone: no column, no superposition.
TEST_P(EveryVariant, TheStressRecomputedFromTheVelocitiesIsTheImposedOne)
{
    const State s = frictional_state();
    const auto& [name, model, control] = GetParam();
    Workspace workspace(exact);
    Evaluation e = evaluate(s, model, control, workspace);
    list_pairs(s, e, workspace);
    const Mat3 E = e.shear_rate * (Mat3() << 0, .5, 0, .5, 0, 0, 0, 0, 0).finished();
    Mat3 moment = Mat3::Zero();
    const auto forces = pair_forces(s, e);
    for (std::size_t k = 0; k < e.pairs.size(); ++k) {
        const PairState& p = e.pairs[k];
        moment +=
            sym(p.pair.separation, forces[k].contact + forces[k].repulsion + forces[k].dashpot);
        if (p.dashpot) continue;
        const auto r = resistance(s, p);
        const auto su = lubrication::velocity_stresslet(r, p.pair.normal, e.nonaffine[p.pair.i],
                                                        e.nonaffine[p.pair.j]);
        const auto se = lubrication::strain_stresslet(r, p.pair.normal, E);
        moment += su.on_i + su.on_j + se.on_i + se.on_j;
    }
    const double eta = model.einstein ? 1 + 2.5 * volume_fraction(s) : 1;
    const double stress = moment(flow, gradient) / s.box.volume() + eta * e.shear_rate;
    const DetailedEvaluation d = evaluate_in_detail(s, model, control, workspace);
    EXPECT_NEAR(stress / d.total_stress()(flow, gradient), 1, 1e-10);
    if (const auto* imposed = std::get_if<ImposedStress>(&control)) {
        EXPECT_NEAR(stress / imposed->value, 1, 1e-10);
    }
}

TEST_P(EveryVariant, TheForcesOnEveryParticleBalance)
{
    const State s = frictional_state();
    const auto& [name, model, control] = GetParam();
    Workspace workspace(exact);
    Evaluation e = evaluate(s, model, control, workspace);
    list_pairs(s, e, workspace);
    std::vector<Vec3> net(s.size(), Vec3::Zero());
    const auto forces = pair_forces(s, e);
    double largest = 0;
    for (std::size_t k = 0; k < e.pairs.size(); ++k) {
        const Vec3 f =
            forces[k].lubrication + forces[k].dashpot + forces[k].contact + forces[k].repulsion;
        net[e.pairs[k].pair.i] += f;
        net[e.pairs[k].pair.j] -= f;
        largest = std::max(largest, forces[k].contact.norm());
    }
    for (int i = 0; i < s.size(); ++i) {
        Vec3 drag = 6 * pi * s.radius[i] * e.nonaffine[i].head<3>();
        if (!model.background_drag) drag.setZero();
        EXPECT_LT((net[i] - drag).norm(), (model.background_drag ? 1e-9 : 1e-6) * largest);
    }
}

TEST_P(EveryVariant, OneSolveAgreesWithASolutionPerForce)
{
    const State s = frictional_state();
    const auto& [name, model, control] = GetParam();
    Workspace direct(exact), iterative({SolverKind::pcg, 1e-11});
    const DetailedEvaluation d = evaluate_in_detail(s, model, control, direct);
    for (Workspace* workspace : {&direct, &iterative}) {
        const Evaluation e = evaluate(s, model, control, *workspace);
        EXPECT_FALSE(e.solve.fell_back);
        EXPECT_NEAR(e.shear_rate / d.evaluation.shear_rate, 1, 1e-8);
        // without drag the part of the solution that the limit removes is the hardest
        EXPECT_LT(largest_difference(d.evaluation.nonaffine, e.nonaffine),
                  model.background_drag ? 1e-8 : 1e-5);
    }
}

// What a sample reports, from two solutions, against a solution for every force.
TEST_P(EveryVariant, ASampleAgreesWithTheDetailedEvaluation)
{
    const State s = frictional_state();
    const auto& [name, model, control] = GetParam();
    Workspace direct(exact), iterative;
    const Sample expected = make_sample(s, evaluate_in_detail(s, model, control, direct));
    const Sample found = make_sample(s, evaluate_sample(s, model, control, iterative));
    for (const SampleField& field : sample_fields()) {
        const double size = std::max(std::abs(expected.*field.value), 0.1);
        EXPECT_NEAR(found.*field.value, expected.*field.value, 1e-6 * size) << field.name;
    }
}

TEST_P(EveryVariant, TheDefaultToleranceFindsTheRateWithinOneInTenThousand)
{
    const State s = frictional_state();
    const auto& [name, model, control] = GetParam();
    Workspace direct(exact), standard;
    const double rate = evaluate_in_detail(s, model, control, direct).evaluation.shear_rate;
    EXPECT_NEAR(evaluate(s, model, control, standard).shear_rate / rate, 1, 1e-4);
}

TEST_P(EveryVariant, ImagesLabelsAndOriginDoNotMatter)
{
    const State s = frictional_state();
    const auto& [name, model, control] = GetParam();
    Workspace workspace(exact);
    const DetailedEvaluation before = evaluate_in_detail(s, model, control, workspace);
    const Mat3 stress = before.total_stress();

    State moved = s;
    Random random(5);
    const Vec3 shift = random.vector(30);
    for (Vec3& x : moved.position) x += shift;
    for (int i = 0; i < s.size(); i += 4)
        moved.position[i] +=
            Vec3(-s.box.length.x() + 2 * s.box.offset, 2 * s.box.length.y(), 3 * s.box.length.z());
    std::vector<int> label(s.size());
    std::iota(label.begin(), label.end(), 0);
    std::reverse(label.begin(), label.end());
    State renamed = moved;
    for (int i = 0; i < s.size(); ++i) {
        renamed.position[label[i]] = moved.position[i];
        renamed.radius[label[i]] = moved.radius[i];
    }
    for (Contact& c : renamed.contacts) {
        // both spheres exchange their roles: the relative stretch changes its sign
        c = {label[c.j], label[c.i], -c.spring, -c.rolling, c.sliding};
    }
    std::sort(renamed.contacts.begin(), renamed.contacts.end(),
              [](const Contact& p, const Contact& q) {
                  return std::pair(p.i, p.j) < std::pair(q.i, q.j);
              });
    const DetailedEvaluation after = evaluate_in_detail(renamed, model, control, workspace);
    EXPECT_NEAR(after.evaluation.shear_rate / before.evaluation.shear_rate, 1, 1e-9);
    EXPECT_LT((after.total_stress() - stress).norm(), 1e-9 * stress.norm());
    Velocities back(s.size());
    for (int i = 0; i < s.size(); ++i) back[i] = after.evaluation.nonaffine[label[i]];
    EXPECT_LT(largest_difference(before.evaluation.nonaffine, back),
              model.background_drag ? 1e-9 : 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Model, EveryVariant, testing::ValuesIn(variants()),
                         [](const auto& variant) { return std::string(variant.param.name); });

TEST(Evaluation, TheResistanceMatrixIsSymmetricPositiveDefinite)
{
    const State s = frictional_state(40);
    Workspace workspace(exact);
    prepare(s, {}, ImposedStress{5}, nullptr, workspace.buffers());
    const ResistanceMatrix& R = workspace.buffers().matrix;
    const int size = 6 * s.size();
    Eigen::MatrixXd dense(size, size);
    Velocities unit(s.size(), Vec6::Zero()), column;
    SlicedVector sliced, product;
    for (int c = 0; c < size; ++c) {
        unit[c / 6][c % 6] = 1;
        to_slices(unit, *R.slices, sliced);
        multiply(R, sliced, product);
        from_slices(product, *R.slices, column);
        unit[c / 6][c % 6] = 0;
        for (int i = 0; i < s.size(); ++i) dense.block<6, 1>(6 * i, c) = column[i];
    }
    EXPECT_LT((dense - dense.transpose()).cwiseAbs().maxCoeff(),
              1e-13 * dense.cwiseAbs().maxCoeff());
    const auto eigenvalues = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense).eigenvalues();
    // the drag of the smallest sphere bounds the spectrum from below
    EXPECT_GT(eigenvalues.minCoeff(), 6 * pi * (1 - 1e-9));
}

TEST(Evaluation, DoublingForcesAndStressDoublesTheRate)
{
    const State s = frictional_state();
    Workspace workspace(exact);
    Model doubled;
    doubled.repulsion_amplitude = RepulsionAmplitude::derjaguin;
    const double once = evaluate(s, {}, ImposedStress{2.5}, workspace).shear_rate;
    const double twice = evaluate(s, doubled, ImposedStress{5}, workspace).shear_rate;
    EXPECT_NEAR(twice / once, 2, 1e-10);
}

TEST(Evaluation, OneSphereMovesWithTheFlowAndHasEinsteinsViscosity)
{
    const State s = single_sphere(1.4, 12);
    Workspace workspace;
    const DetailedEvaluation d = evaluate_in_detail(s, {}, ImposedStress{3}, workspace);
    const double phi = 4 * pi / 3 * 1.4 * 1.4 * 1.4 / (12 * 12 * 12);
    EXPECT_NEAR(3 / d.evaluation.shear_rate, 1 + 2.5 * phi, 1e-14);
    EXPECT_LT(d.evaluation.nonaffine[0].norm(), 1e-14);
    const Velocities v = total_velocities(s, d.evaluation);
    EXPECT_NEAR(v[0][0], 2 * d.evaluation.shear_rate, 1e-14);   // U_inf at y = 2
    EXPECT_NEAR(v[0][5], -d.evaluation.shear_rate / 2, 1e-14);  // half the vorticity
}

TEST(Evaluation, TwoDistantRepellingSpheresFeelStokesDrag)
{
    State s;
    s.box.length = Vec3(20, 20, 20);
    s.position = {Vec3(5, 5, 5), Vec3(5 + 2.4 * 1.3, 5, 5)};
    s.radius = {1, 1.4};
    Model m;
    m.lubrication_range = 0.1;  // no lubrication at xi = 0.6
    m.repulsion_range = 1;
    m.stiffness_scale = StiffnessScale::fixed;
    m.debye_length = 0.5;
    Workspace workspace(exact);
    const Evaluation e = evaluate(s, m, ImposedRate{0}, workspace);
    const double gap = 2.4 * 1.3 - 2.4;
    const double force = 6 * pi * (1 * 1.4 / 2.4) * std::exp(-gap / 0.5);
    EXPECT_NEAR(e.nonaffine[0][0], -force / (6 * pi * 1.0), 1e-12);
    EXPECT_NEAR(e.nonaffine[1][0], force / (6 * pi * 1.4), 1e-12);
}

TEST(Evaluation, AMirroredStateFlowsLikeTheOriginalInReverse)
{
    const State s = frictional_state();
    Model model;
    model.stiffness_scale = StiffnessScale::fixed;
    model.rolling_friction = 0.2;
    model.rolling_stiffness = 50;
    State turned = s;
    for (Contact& contact : turned.contacts) contact.rolling = 0.001 * contact.spring;
    const State mirror = mirrored(turned);
    Workspace first(exact), second(exact);
    const DetailedEvaluation back = evaluate_in_detail(turned, model, ImposedStress{-3}, first);
    const DetailedEvaluation forth = evaluate_in_detail(mirror, model, ImposedStress{3}, second);
    const double rate = back.evaluation.shear_rate;
    EXPECT_LT(rate, 0);
    EXPECT_NEAR(forth.evaluation.shear_rate, -rate, 1e-9 * std::abs(rate));
    const Sample a = make_sample(turned, back), b = make_sample(mirror, forth);
    EXPECT_NEAR(b.stress_contact, -a.stress_contact, 1e-9 * std::abs(a.stress_contact));
    EXPECT_NEAR(b.particle_pressure, a.particle_pressure, 1e-9 * std::abs(a.particle_pressure));
}

TEST(Evaluation, LoadingAStoredStateChangesNothing)
{
    const State s = frictional_state();
    Workspace workspace(exact);
    const Model model;
    const Frame frame = make_frame(s, evaluate_in_detail(s, model, ImposedStress{5}, workspace));
    const Frame again = make_frame(
        frame.state, evaluate_in_detail(frame.state, model, ImposedStress{5}, workspace));
    ASSERT_EQ(frame.state.contacts.size(), again.state.contacts.size());
    for (std::size_t k = 0; k < again.state.contacts.size(); ++k) {
        EXPECT_LT((frame.state.contacts[k].spring - again.state.contacts[k].spring).norm(), 1e-16);
        EXPECT_EQ(frame.state.contacts[k].sliding, again.state.contacts[k].sliding);
    }
}

TEST(Evaluation, AWorkspaceServesStatesOfDifferentSizes)
{
    const State small = frictional_state(40), large = frictional_state(80);
    Workspace shared({SolverKind::pcg, 1e-10}), own({SolverKind::pcg, 1e-10});
    evaluate(small, {}, ImposedStress{5}, shared);
    const double expected = evaluate(large, {}, ImposedStress{5}, own).shear_rate;
    EXPECT_NEAR(evaluate(large, {}, ImposedStress{5}, shared).shear_rate / expected, 1, 1e-9);
}

TEST(Evaluation, CoincidingParticlesAreAnErrorThatNamesThem)
{
    State s = single_sphere(1, 12);
    s.position.push_back(s.position[0]);
    s.radius.push_back(1);
    Workspace workspace;
    try {
        evaluate(s, {}, ImposedStress{1}, workspace);
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::numerics);
        EXPECT_NE(std::string(error.what()).find("particles 0 and 1"), std::string::npos);
    }
}

TEST(Evaluation, AStressScaledStiffnessNeedsAnImposedStress)
{
    const State s = single_sphere(1, 12);
    Workspace workspace;
    EXPECT_THROW(evaluate(s, {}, ImposedRate{1}, workspace), Error);
}

}
