#include "engine/jamming.h"

#include "engine/error.h"
#include "engine/step.h"
#include "tests/support/random_state.h"

#include <gtest/gtest.h>
#include <cmath>

namespace sigmaflow {

namespace {

// Shears until the monitor speaks or a strain or time is reached; returns true if jammed.
bool jams(State& s, double stress, double strain, double time, JammingWindow& window,
          const Stepping& stepping = {}, const SolverSettings& solver = {})
{
    Workspace workspace(solver);
    JammingMonitor monitor(stress);
    const Model model;
    while (s.strain < strain && s.time < time) {
        const Evaluation e =
            advance(s, model, ImposedStress{stress}, stepping, {strain, time}, workspace);
        if (monitor.observe(s, e)) {
            window = monitor.last_window();
            return true;
        }
    }
    window = monitor.last_window();
    return false;
}

}

TEST(Jamming, ASuspensionAboveItsShearJammingDensityJamsAndCarriesTheStressByForces)
{
    State s = support::dense_state(50, 0.61, 0, 1);
    JammingWindow window;
    ASSERT_TRUE(jams(s, 20, 5, 100, window));
    EXPECT_LT(s.strain, 0.5);
    EXPECT_LT(window.force_residual, 0.01);
    EXPECT_GT(window.mean_viscosity, 1e5);
    Workspace workspace;
    const DetailedEvaluation d = evaluate_in_detail(s, {}, ImposedStress{20}, workspace);
    const Sample sample = make_sample(s, d);
    EXPECT_NEAR((sample.stress_contact + sample.stress_repulsion) / 20, 1, 1e-3);
    EXPECT_GT(sample.contact_number, 3);
}

TEST(Jamming, TheStressOfJammingIsBracketed)
{
    int asked = 0;
    const auto jams_above = [&](double threshold) {
        return [&asked, threshold](double stress) { return ++asked, stress >= threshold; };
    };
    const JammingBracket found = bracket_jamming_stress(0.1, 100, 1.1, jams_above(7));
    EXPECT_LT(found.flows, 7);
    EXPECT_GE(found.jams, 7);
    EXPECT_LE(found.jams / found.flows, 1.1);
    EXPECT_EQ(asked, 2 + 7);  // ln 1000/2^7 < ln 1.1 < ln 1000/2^6
    EXPECT_EQ(bracket_jamming_stress(1, 10, 1.1, jams_above(0.5)).jams, 1);
    EXPECT_EQ(bracket_jamming_stress(1, 10, 1.1, jams_above(0.5)).flows, 0);
    EXPECT_EQ(bracket_jamming_stress(1, 10, 1.1, jams_above(20)).flows, 10);
    EXPECT_EQ(bracket_jamming_stress(1, 10, 1.1, jams_above(20)).jams, 0);
    EXPECT_THROW(bracket_jamming_stress(2, 1, 1.1, jams_above(1)), Error);
    EXPECT_THROW(bracket_jamming_stress(1, 2, 1, jams_above(1)), Error);
}

// Thresholds that scatter by a factor of 1.2, found to a factor of 1.3: the error is the scatter of
// the result over many repetitions.
TEST(Jamming, TheStressOfJammingHasAnErrorFromScatterAndBrackets)
{
    support::Random random(4);
    double pull2 = 0, mean_error = 0;
    constexpr int repetitions = 400, starts = 8;
    for (int k = 0; k < repetitions; ++k) {
        std::vector<JammingBracket> brackets;
        for (int i = 0; i < starts; ++i) {
            double normal = -6;
            for (int j = 0; j < 12; ++j) normal += random.uniform(0, 1);
            const double threshold = 5 * std::pow(1.2, normal);
            brackets.push_back(
                bracket_jamming_stress(0.5 * random.uniform(0.8, 1), 60, 1.3,
                                       [&](double stress) { return stress >= threshold; }));
        }
        const Value stress = jamming_stress(brackets);
        pull2 += std::pow(std::log(stress.mean / 5) * stress.mean / stress.standard_error, 2);
        mean_error += stress.standard_error / stress.mean / repetitions;
    }
    EXPECT_NEAR(pull2 / repetitions, 1, 0.4);  // eight starts: errors are known to a quarter
    EXPECT_GT(mean_error, std::log(1.2) / std::sqrt(8));
    EXPECT_THROW(jamming_stress(std::vector<JammingBracket>{{0, 1}}), Error);
    EXPECT_THROW(jamming_stress({}), Error);
}

class StiffCorner : public testing::TestWithParam<int> {};

// The long steps of the implicit scheme: at rest the springs must find their balance all the same.
TEST_P(StiffCorner, ASuspensionThatCannotFlowComesToRest)
{
    State s = support::dense_state(100, 0.61, 0, GetParam());
    JammingWindow window;
    const SolverSettings solver{SolverKind::pcg, 1e-3};
    ASSERT_TRUE(jams(s, 20, 2, 400, window, {Scheme::implicit, 1e-2}, solver));
    EXPECT_LT(s.strain, 0.5);
    EXPECT_LT(window.force_residual, 0.01);
    Workspace workspace;
    const Sample sample = make_sample(s, evaluate_in_detail(s, {}, ImposedStress{20}, workspace));
    EXPECT_NEAR((sample.stress_contact + sample.stress_repulsion) / 20, 1, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Seeds, StiffCorner, testing::Range(1, 9));

TEST(Jamming, AFlowingSuspensionIsNotJammed)
{
    State s = support::dense_state(50, 0.50, 0, 1);
    JammingWindow window;
    EXPECT_FALSE(jams(s, 20, 2, 100, window));
    EXPECT_GE(s.strain, 2);
    EXPECT_GT(window.duration, 0);
    EXPECT_LT(window.mean_viscosity, 1e4);
}

TEST(Jamming, TheForceResidualOfAnUnbalancedPairIsOne)
{
    State s;
    s.box.length = Vec3(12, 12, 12);
    s.position = {Vec3(5, 5, 5), Vec3(7.01, 5, 5)};
    s.radius = {1, 1};
    EXPECT_NEAR(force_residual(s, {}, ImposedStress{1}), 1, 1e-12);
}

}
