// Long steps and short ones sample the same steady flow (label long).
#include "engine/statistics.h"
#include "engine/step.h"
#include "tests/support/random_state.h"

#include <gtest/gtest.h>
#include <cmath>

namespace sigmaflow {

namespace {

struct Flow {
    std::vector<double> shear_rate, contact_number, particle_pressure;
};

// Sheared by 2, then sampled every 0.02 for `strain` more.
Flow sheared(const Stepping& stepping, double tolerance, double stress, double strain)
{
    State s = support::dense_state(100, 0.54, 0, 7);
    const Model model;
    const Control control = ImposedStress{stress};
    Workspace workspace({SolverKind::pcg, tolerance});
    Flow flow;
    for (int row = 1; row * 0.02 < strain + 2; ++row) {
        while (s.strain < row * 0.02 - 1e-12)
            recycle(advance(s, model, control, stepping, {row * 0.02}, workspace), workspace);
        if (row * 0.02 < 2) continue;
        const Sample sample = make_sample(s, evaluate_sample(s, model, control, workspace));
        flow.shear_rate.push_back(sample.shear_rate);
        flow.contact_number.push_back(sample.contact_number);
        flow.particle_pressure.push_back(sample.particle_pressure);
    }
    return flow;
}

void expect_same_mean(const std::vector<double>& one, const std::vector<double>& other)
{
    const Estimate a = estimate_mean(one), b = estimate_mean(other);
    EXPECT_LT(a.standard_error, 0.05 * a.mean);
    EXPECT_LT(b.standard_error, 0.05 * b.mean);
    EXPECT_LT(std::abs(a.mean - b.mean), 3.5 * std::hypot(a.standard_error, b.standard_error));
}

}

class SteadyState : public testing::TestWithParam<double> {};

TEST_P(SteadyState, IsTheSameForLongImplicitAndShortExplicitSteps)
{
    const Flow heun = sheared({Scheme::heun, 1e-3}, 1e-4, GetParam(), 40);
    const Flow implicit = sheared({Scheme::implicit, 1e-2}, 1e-3, GetParam(), 60);
    expect_same_mean(heun.shear_rate, implicit.shear_rate);
    expect_same_mean(heun.contact_number, implicit.contact_number);
    expect_same_mean(heun.particle_pressure, implicit.particle_pressure);
}

INSTANTIATE_TEST_SUITE_P(Stresses, SteadyState, testing::Values(1., 5.));

}
