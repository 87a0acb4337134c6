// A run that is stopped, stored as bytes and gone on with must not differ in a single bit.
#include "engine/memory.h"
#include "engine/error.h"
#include "engine/step.h"
#include "tests/support/random_state.h"

#include <gtest/gtest.h>

namespace sigmaflow {
namespace {

struct Setting {
    const char* name;
    Scheme scheme;
    SolverKind solver;
    bool imposed_stress;
    bool dashpot;
    double friction;
};

void PrintTo(const Setting& setting, std::ostream* out)
{
    *out << setting.name;
}

class Memory : public testing::TestWithParam<Setting> {
protected:
    Model model() const
    {
        Model m;
        if (GetParam().dashpot) m.contact_hydrodynamics = ContactHydrodynamics::dashpot;
        if (!GetParam().imposed_stress) m.stiffness_scale = StiffnessScale::fixed;
        m.friction_static = m.friction_dynamic = GetParam().friction;
        return m;
    }
    Control control() const
    {
        return GetParam().imposed_stress ? Control(ImposedStress{3}) : Control(ImposedRate{0.05});
    }
    SolverSettings solver(int threads) const
    {
        const bool implicit = GetParam().scheme == Scheme::implicit;
        return {GetParam().solver, implicit ? 1e-3 : 1e-5, threads};
    }

    /// Steps with samples and frames in between, as a run makes them; all results as bytes.
    void go_on(State& state, Workspace& workspace, int from, int to, std::string& results) const
    {
        const bool implicit = GetParam().scheme == Scheme::implicit;
        const Stepping stepping{GetParam().scheme, implicit ? 1e-2 : 5e-3};
        ArchiveWriter bytes;
        for (int k = from; k < to; ++k) {
            if (k % 5 == 0) {
                const SampledEvaluation sample =
                    evaluate_sample(state, model(), control(), workspace);
                bytes(sample.evaluation.shear_rate, sample.stress.total);
            }
            if (k % 7 == 0) {
                const DetailedEvaluation frame =
                    evaluate_in_detail(state, model(), control(), workspace);
                bytes(frame.evaluation.shear_rate, frame.total_stress());
            }
            Evaluation e =
                advance(state, model(), control(), stepping, {1, 1e9}, workspace, nullptr);
            bytes(e.shear_rate, e.solve.iterations, e.solve.residual);
            recycle(std::move(e), workspace);
            bytes(state);
        }
        results += bytes.bytes();
    }
};

TEST_P(Memory, GoesOnBitByBit)
{
    const int steps = 36;
    State start = support::dense_state(60, 0.56, 0.3, 11);
    {
        Workspace workspace(solver(1));
        std::string unused;
        go_on(start, workspace, 0, 20, unused);  // contacts with springs
    }
    std::string uninterrupted;
    State state = start;
    Workspace workspace(solver(1));
    go_on(state, workspace, 0, steps, uninterrupted);

    for (int stop : {0, 1, 2, 5, 7, 8, 14, 21, 30}) {
        std::string results;
        State first = start;
        Workspace one(solver(1));
        go_on(first, one, 0, stop, results);
        ArchiveWriter stored;
        stored(first);
        save_memory(first, one, stored);

        ArchiveReader reader(stored.bytes());
        State second;
        reader(second);
        Workspace other(solver(stop == 5 ? 2 : 1));
        restore_memory(second, model(), other, reader);
        reader.finish();
        ArchiveWriter again;
        again(second);
        save_memory(second, other, again);
        EXPECT_EQ(again.bytes(), stored.bytes()) << "stored again after " << stop << " steps";
        go_on(second, other, stop, steps, results);
        EXPECT_TRUE(results == uninterrupted) << "after " << stop << " steps";
    }
}

INSTANTIATE_TEST_SUITE_P(
    Runs, Memory,
    testing::Values(
        Setting{"implicit_pcg_stress", Scheme::implicit, SolverKind::pcg, true, false, 1},
        Setting{"implicit_pcg_rate", Scheme::implicit, SolverKind::pcg, false, false, 1},
        Setting{"implicit_frictionless", Scheme::implicit, SolverKind::pcg, true, false, 0},
        Setting{"implicit_cholesky", Scheme::implicit, SolverKind::cholesky, true, false, 1},
        Setting{"implicit_lagged", Scheme::implicit, SolverKind::lagged_cholesky, true, false, 1},
        Setting{"heun_pcg_stress", Scheme::heun, SolverKind::pcg, true, false, 1},
        Setting{"heun_pcg_rate", Scheme::heun, SolverKind::pcg, false, false, 1},
        Setting{"heun_lagged", Scheme::heun, SolverKind::lagged_cholesky, true, false, 1},
        Setting{"heun_dashpot", Scheme::heun, SolverKind::pcg, true, true, 1},
        Setting{"heun_dashpot_rate", Scheme::heun, SolverKind::pcg, false, true, 1},
        Setting{"heun_dashpot_lagged", Scheme::heun, SolverKind::lagged_cholesky, true, true, 1},
        Setting{"euler_pcg_stress", Scheme::euler, SolverKind::pcg, true, false, 1},
        Setting{"euler_cholesky", Scheme::euler, SolverKind::cholesky, true, false, 1}),
    [](const auto& test) { return std::string(test.param.name); });

// What is stored matters: without it the run differs in its last bits, so the test above can fail.
TEST(Memory, WithoutItTheLastBitsDiffer)
{
    State state = support::dense_state(60, 0.56, 0.3, 11);
    const Model model;
    const Control control = ImposedStress{3};
    const Stepping stepping{Scheme::implicit, 1e-2};
    Workspace workspace({SolverKind::pcg, 1e-3});
    for (int k = 0; k < 20; ++k) advance(state, model, control, stepping, {1, 1e9}, workspace);
    State forgetful = state;
    Workspace fresh({SolverKind::pcg, 1e-3});
    advance(state, model, control, stepping, {1, 1e9}, workspace);
    advance(forgetful, model, control, stepping, {1, 1e9}, fresh);
    EXPECT_NE(state.position, forgetful.position);
}

// Damage that a checksum would not find, e.g. in a file that was made to deceive.
TEST(Memory, DamagedBytesAreRefusedOrHarmless)
{
    State state = support::dense_state(20, 0.5, 0.3, 3);
    const Model model;
    const Control control = ImposedStress{3};
    Workspace workspace({SolverKind::lagged_cholesky, 1e-3});
    for (int k = 0; k < 20; ++k)
        advance(state, model, control, {Scheme::implicit, 1e-2}, {1, 1e9}, workspace);
    ArchiveWriter stored;
    stored(state);
    save_memory(state, workspace, stored);

    support::Random random(5);
    int refused = 0;
    for (int k = 0; k < 3000; ++k) {
        std::string bytes = stored.bytes();
        const auto place = static_cast<std::size_t>(random.uniform(0, 1) * random.uniform(0, 1) *
                                                    static_cast<double>(bytes.size()));
        if (k % 3 == 0)
            bytes.resize(place);
        else
            bytes[place] = static_cast<char>(random.uniform(-128, 128));
        try {
            ArchiveReader reader(bytes);
            State damaged;
            reader(damaged);
            check_stored_state(damaged);
            Workspace other({SolverKind::lagged_cholesky, 1e-3});
            restore_memory(damaged, model, other, reader);
            reader.finish();
        } catch (const Error& error) {
            EXPECT_TRUE(error.kind() == ErrorKind::input || error.kind() == ErrorKind::numerics)
                << error.what();
            ++refused;
        }
    }
    EXPECT_GT(refused, 1000);
}

}
}
