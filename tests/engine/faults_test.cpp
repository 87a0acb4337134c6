// Values that are not finite, brought in on purpose: every one is caught in the same step by an
// Error(numerics) that names it, with the state as it was, or it does no harm (a mere guess).
#include "engine/checks.h"
#include "engine/error.h"
#include "engine/step.h"
#include "engine/workspace.h"
#include "tests/support/random_state.h"

#include <gtest/gtest.h>
#include <cmath>
#include <cstring>
#include <functional>
#include <iostream>
#include <limits>

namespace sigmaflow {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();
constexpr double tolerance = 1e-8;

/// What a fault can be done to before a step.
struct Flow {
    State state;
    Model model;
    Control control;
    Workspace workspace;
    Stepping stepping;

    void advance_once()
    {
        recycle(advance(state, model, control, stepping, {}, workspace), workspace);
    }
};

struct Scene {
    std::string name;
    Scheme scheme;
    Control control;
    SolverKind solver;
};

const Scene scenes[] = {
    {"heun stress pcg", Scheme::heun, ImposedStress{3}, SolverKind::pcg},
    {"euler rate pcg", Scheme::euler, ImposedRate{0.05}, SolverKind::pcg},
    {"implicit stress pcg", Scheme::implicit, ImposedStress{3}, SolverKind::pcg},
    {"implicit rate cholesky", Scheme::implicit, ImposedRate{0.05}, SolverKind::cholesky},
    {"heun stress cholesky", Scheme::heun, ImposedStress{3}, SolverKind::cholesky},
    {"heun stress lagged", Scheme::heun, ImposedStress{3}, SolverKind::lagged_cholesky},
};

const State& start()
{
    static const State state = support::dense_state(40, 0.55, 0.2, 4);
    return state;
}

Flow flow_of(const Scene& scene)
{
    Model m;
    m.stiffness_scale = StiffnessScale::fixed;
    m.rolling_stiffness = 10;
    m.rolling_friction = 0.1;
    const double displacement = scene.scheme == Scheme::implicit ? 1e-2 : 2e-3;
    return {start(),
            m,
            scene.control,
            Workspace({scene.solver, tolerance}),
            {scene.scheme, displacement}};
}

struct Fault {
    std::string name;
    std::function<void(Flow&, double value)> inject;
    std::string says;            // in the message, if it is caught
    bool in_workspace = false;   // which stays injured
    bool implicit_only = false;  // of what explicit schemes do not have
};

std::vector<Fault> state_faults()
{
    return {
        {"position", [](Flow& r, double v) { r.state.position[12].y() = v; },
         "position of particle 12"},
        {"last position", [](Flow& r, double v) { r.state.position.back().z() = v; },
         "position of particle 39"},
        {"box offset", [](Flow& r, double v) { r.state.box.offset = v; }, "box offset"},
        {"box length", [](Flow& r, double v) { r.state.box.length.z() = v; }, "box length"},
        {"radius", [](Flow& r, double v) { r.state.radius[7] = v; }, "radius of particle 7"},
        {"spring", [](Flow& r, double v) { r.state.contacts.at(3).spring.x() = v; },
         "spring of the contact of particles"},
        {"rolling", [](Flow& r, double v) { r.state.contacts.back().rolling.z() = v; },
         "spring of the contact of particles"},
        {"strain", [](Flow& r, double v) { r.state.strain = v; }, "strain"},
        {"time", [](Flow& r, double v) { r.state.time = v; }, "time"},
        {"time step", [](Flow& r, double v) { r.state.time_step = v; }, "time step"},
    };
}

std::vector<Fault> model_faults()
{
    std::vector<Fault> faults;
    const auto add = [&](const char* name, double Model::*value) {
        faults.push_back({name, [value](Flow& r, double v) { r.model.*value = v; }, name});
    };
    add("lubrication_delta", &Model::lubrication_delta);
    add("lubrication_range", &Model::lubrication_range);
    add("contact_relaxation_time", &Model::contact_relaxation_time);
    add("normal_stiffness", &Model::normal_stiffness);
    add("tangential_stiffness", &Model::tangential_stiffness);
    add("friction_static", &Model::friction_static);
    add("friction_dynamic", &Model::friction_dynamic);
    add("critical_load", &Model::critical_load);
    add("rolling_stiffness", &Model::rolling_stiffness);
    add("rolling_friction", &Model::rolling_friction);
    add("repulsion", &Model::repulsion);
    add("debye_length", &Model::debye_length);
    add("repulsion_range", &Model::repulsion_range);
    add("drag_factor", &Model::drag_factor);
    faults.push_back({"control",
                      [](Flow& r, double v) {
                          if (std::holds_alternative<ImposedStress>(r.control))
                              r.control = ImposedStress{v};
                          else
                              r.control = ImposedRate{v};
                      },
                      "imposed"});
    return faults;
}

// Steps with finite parameters whose forces overflow: no check of the input can see them.
std::vector<Fault> force_faults()
{
    return {
        {"contact force", [](Flow& r, double) { r.model.normal_stiffness = 1e308; }, "contact"},
        {"repulsion", [](Flow& r, double) { r.model.repulsion = 1e308; }, ""},
        {"resistance", [](Flow& r, double) { r.model.lubrication_delta = 1e-310; }, ""},
        {"drag", [](Flow& r, double) { r.model.drag_factor = 1e308; }, ""},
    };
}

using Buffers = Workspace::Buffers;

Fault in_workspace(const char* name, const std::function<void(Buffers&, double)>& inject,
                   bool implicit_only = false)
{
    return {name, [inject](Flow& r, double v) { inject(r.workspace.buffers(), v); }, "", true,
            implicit_only};
}

std::vector<Fault> guess_faults()
{
    return {
        in_workspace("guess", [](Buffers& b, double v) { b.history.solution[0].at(9)[2] = v; }),
        in_workspace("earlier guess",
                     [](Buffers& b, double v) { b.history.solution[1].at(9)[2] = v; }),
        in_workspace("rate of the guess", [](Buffers& b, double v) { b.history.rate[0] = v; }),
        in_workspace("old solution", [](Buffers& b, double v) { b.solution.at(0).c[0][0] = v; }),
    };
}

std::vector<Fault> matrix_faults()
{
    // of a lane that a pair uses
    const auto member = [](Buffers& b, d8 PairShape::*m) -> double& {
        const int pair = b.slices.pair_of.at(b.touching.at(0));
        return reinterpret_cast<double*>(&(b.table.shape.at(pair / lanes).*m))[pair % lanes];
    };
    return {
        in_workspace("resistance XA",
                     [member](Buffers& b, double v) { member(b, &PairShape::xa) = v; }),
        in_workspace("resistance YC",
                     [member](Buffers& b, double v) { member(b, &PairShape::yc12) = v; }),
        in_workspace(
            "mean motion",
            [](Buffers& b, double v) {
                for (PastStep& past : b.past)
                    if (!past.mean.nonaffine.empty()) past.mean.nonaffine[5][1] = v;
            },
            true),
        in_workspace(
            "mean slip",
            [](Buffers& b, double v) {
                for (PastStep& past : b.past)
                    if (!past.mean.motion.empty()) past.mean.motion[0].slip.x() = v;
            },
            true),
        in_workspace(
            "mean spring",
            [](Buffers& b, double v) {
                for (PastStep& past : b.past)
                    if (!past.mean.contacts.empty()) past.mean.contacts[0].memory.spring.x() = v;
            },
            true),
    };
}

double difference(const State& a, const State& b)
{
    double largest = std::max({std::abs(a.strain - b.strain), std::abs(a.time - b.time),
                               std::abs(a.box.offset - b.box.offset)});
    for (int i = 0; i < a.size(); ++i)
        largest = std::max(largest, separation(a.box, a.position[i], b.position[i]).d.norm());
    if (a.contacts.size() != b.contacts.size()) return inf;
    for (std::size_t k = 0; k < a.contacts.size(); ++k)
        largest = std::max(largest, (a.contacts[k].spring - b.contacts[k].spring).norm());
    return std::isnan(largest) ? inf : largest;
}

// not a number is equal to itself here
bool same_bits(const State& a, const State& b)
{
    const auto same = [](const void* p, const void* q, std::size_t bytes) {
        return bytes == 0 || std::memcmp(p, q, bytes) == 0;
    };
    const double clock_a[] = {a.strain, a.time, a.time_step, a.box.offset};
    const double clock_b[] = {b.strain, b.time, b.time_step, b.box.offset};
    bool equal = same(clock_a, clock_b, sizeof clock_a) &&
                 same(&a.box.length, &b.box.length, sizeof(Vec3)) &&
                 a.position.size() == b.position.size() && a.contacts.size() == b.contacts.size() &&
                 same(a.position.data(), b.position.data(), a.position.size() * sizeof(Vec3)) &&
                 same(a.radius.data(), b.radius.data(), a.size() * sizeof(double));
    for (std::size_t k = 0; equal && k < a.contacts.size(); ++k)
        equal = a.contacts[k].i == b.contacts[k].i && a.contacts[k].j == b.contacts[k].j &&
                same(&a.contacts[k].spring, &b.contacts[k].spring, sizeof(Vec3)) &&
                same(&a.contacts[k].rolling, &b.contacts[k].rolling, sizeof(Vec3));
    return equal;
}

struct Tally {
    int injected = 0, caught = 0, harmless = 0;
};

/// Two equal runs of some steps; the fault is done to one of them, and both take one step more.
void try_fault(const Scene& scene, const Fault& fault, double value, int steps, Tally& tally)
{
    SCOPED_TRACE(scene.name + ", " + fault.name + " = " + std::to_string(value) + " after " +
                 std::to_string(steps) + " steps");
    Flow sound = flow_of(scene), injured = flow_of(scene);
    for (int k = 0; k < steps; ++k) {
        sound.advance_once();
        injured.advance_once();
    }
    ASSERT_TRUE(same_bits(sound.state, injured.state));
    const State good = injured.state;
    const Model model = injured.model;
    const Control control = injured.control;
    ASSERT_GT(good.contacts.size(), 3u);
    fault.inject(injured, value);
    const State before = injured.state;
    sound.advance_once();
    ++tally.injected;
    bool caught = false;
    try {
        injured.advance_once();
    } catch (const Error& error) {
        caught = true;
        EXPECT_EQ(error.kind(), ErrorKind::numerics) << error.what();
        EXPECT_NE(std::string(error.what()).find(fault.says), std::string::npos) << error.what();
        EXPECT_TRUE(same_bits(injured.state, before)) << "the state was changed";
    }
    if (!caught) {
        EXPECT_TRUE(fault.in_workspace) << "was not caught";
        EXPECT_LT(difference(injured.state, sound.state), 100 * tolerance);
        ++tally.harmless;
        return;
    }
    ++tally.caught;
    if (fault.in_workspace) return;
    // the workspace has taken no harm: the good state goes on as if nothing had been
    injured.state = good;
    injured.model = model;
    injured.control = control;
    injured.advance_once();
    EXPECT_LT(difference(injured.state, sound.state), 100 * tolerance);
}

std::string error_of(const std::function<void()>& action)
{
    try {
        action();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::numerics) << error.what();
        return error.what();
    }
    return "no error";
}

#define EXPECT_SAYS(action, words)                              \
    do {                                                        \
        const std::string said = error_of([&] { action; });     \
        EXPECT_NE(said.find(words), std::string::npos) << said; \
    } while (false)

}

TEST(Faults, EveryOneIsCaughtInTheSameStepOrDoesNoHarm)
{
    Tally all;
    const auto try_all = [&](const char* what, const std::vector<Fault>& faults,
                             std::initializer_list<double> values) {
        Tally tally;
        int turn = 0;
        for (const Scene& scene : scenes)
            for (const Fault& fault : faults)
                for (double value : values) {
                    if (fault.implicit_only && scene.scheme != Scheme::implicit) continue;
                    try_fault(scene, fault, value, 2 + ++turn % 5, tally);
                }
        std::cout << what << ": " << tally.injected << " injected, " << tally.caught << " caught, "
                  << tally.harmless << " harmless\n";
        all.injected += tally.injected;
    };
    try_all("state", state_faults(), {nan, inf, -inf});
    try_all("model", model_faults(), {nan, inf});
    try_all("overflowing forces", force_faults(), {nan});
    try_all("guesses", guess_faults(), {nan, inf, 1e300});
    try_all("matrix and memory of the workspace", matrix_faults(), {nan, inf});
    EXPECT_GE(all.injected, 100);
}

TEST(Faults, SamplesRefuseAStateThatIsNotFinite)
{
    for (const Fault& fault : state_faults())
        for (double value : {nan, inf}) {
            SCOPED_TRACE(fault.name);
            Flow run = flow_of(scenes[0]);
            run.advance_once();
            fault.inject(run, value);
            const auto& [state, model, control, workspace, stepping] = run;
            EXPECT_SAYS(evaluate_sample(state, model, control, run.workspace), fault.says);
            EXPECT_SAYS(evaluate_in_detail(state, model, control, run.workspace), fault.says);
        }
}

TEST(Faults, SamplesAreNotSpoiltByWhatIsLeftOfEarlierOnes)
{
    Flow run = flow_of(scenes[0]);
    const auto sample = [&] {
        return make_sample(run.state,
                           evaluate_sample(run.state, run.model, run.control, run.workspace));
    };
    const Sample sound = sample();
    Buffers& b = run.workspace.buffers();
    for (double value : {nan, inf, 1e300})
        for (Velocities* left : {&b.hydrodynamic, &b.history.solution[0]}) {
            left->at(3)[4] = value;
            const Sample again = sample();
            for (const SampleField& field : sample_fields())
                EXPECT_NEAR(again.*field.value, sound.*field.value,
                            1e-6 * std::abs(sound.*field.value) + 1e-9)
                    << field.name;
        }
}

TEST(Faults, StressThatIsNotFiniteIsNamed)
{
    State s;  // far apart: nothing moves relative to the flow
    s.box.length = Vec3(50, 50, 50);
    s.radius = {1, 1};
    s.position = {Vec3(2, 2, 2), Vec3(28, 28, 28)};
    Model m;
    m.stiffness_scale = StiffnessScale::fixed;
    Workspace workspace;
    const Control control = ImposedRate{1e308};
    EXPECT_SAYS(evaluate_in_detail(s, m, control, workspace),
                "the stress solvent_xy is not finite");
    EXPECT_SAYS(evaluate_sample(s, m, control, workspace),
                "the stress of the solvent is not finite");
}

// What a step is given, and what it makes of it.
TEST(Faults, StepsLeaveNothingThatIsNotFinite)
{
    for (Scheme scheme : {Scheme::euler, Scheme::heun}) {
        const auto step_with = [&](const std::function<void(State&, Evaluation&)>& inject) {
            Flow run = flow_of({"", scheme, ImposedStress{3}, SolverKind::pcg});
            run.advance_once();
            Evaluation first = evaluate(run.state, run.model, run.control, run.workspace);
            inject(run.state, first);
            const State before = run.state;
            const std::string said = error_of([&] {
                step(run.state, run.model, run.control, scheme, March::time, 1e-5, first,
                     run.workspace);
            });
            EXPECT_TRUE(same_bits(run.state, before));
            return said;
        };
        for (double value : {nan, inf}) {
            EXPECT_EQ(step_with([&](State& s, Evaluation&) { s.time = value; }),
                      "the time is not finite");
            for (int axis = 0; axis < 3; ++axis)
                EXPECT_EQ(step_with([&](State&, Evaluation& e) { e.nonaffine[5][axis] = value; }),
                          "the position of particle 5 is not finite");
            EXPECT_EQ(step_with([&](State&, Evaluation& e) { e.shear_rate = value; }),
                      "the box offset is not finite");
            const std::string spring =
                step_with([&](State&, Evaluation& e) { e.motion[0].slip.z() = value; });
            EXPECT_TRUE(spring.starts_with("the spring of the contact of particles")) << spring;
        }
    }
    Flow run = flow_of(scenes[2]);
    run.advance_once();
    run.state.time = nan;
    const State before = run.state;
    EXPECT_SAYS(implicit_step(run.state, run.model, run.control, 1e-4, inf, run.workspace),
                "the time is not finite");
    EXPECT_TRUE(same_bits(run.state, before));
}

TEST(Faults, StatesWithoutAMeaningAreRefused)
{
    const auto advance_with = [](const std::function<void(State&)>& change, Scheme scheme) {
        Flow run = flow_of({"", scheme, ImposedStress{3}, SolverKind::pcg});
        run.advance_once();
        change(run.state);
        const State before = run.state;
        const std::string said = error_of([&] { run.advance_once(); });
        EXPECT_TRUE(same_bits(run.state, before));
        return said;
    };
    struct Case {
        std::string says;
        std::function<void(State&)> change;
    };
    const Case cases[] = {
        {"radius of particle 5 is -1", [](State& s) { s.radius[5] = -1; }},
        {"radius of particle 5 is 0", [](State& s) { s.radius[5] = 0; }},
        {"contacts are not pairs i < j < 40 in order",
         [](State& s) { std::swap(s.contacts[1].i, s.contacts[1].j); }},
        {"contacts are not pairs", [](State& s) { std::swap(s.contacts[1], s.contacts[2]); }},
        {"contacts are not pairs", [](State& s) { s.contacts.back().j = 40; }},
        {"contacts are not pairs", [](State& s) { s.contacts[0].i = -1; }},
        {"39 positions", [](State& s) { s.position.pop_back(); }},
        {"box lengths", [](State& s) { s.box.length.y() = -9; }},
        {"position of particle 3 lies more than 1e+06 box lengths",
         [](State& s) { s.position[3].x() = 1e17; }},
        {"box offset is more than", [](State& s) { s.box.offset = -1e17; }},
        {"particles 4 and 11", [](State& s) { s.position[11] = s.position[4] + Vec3(0, 0, 0.1); }},
    };
    for (const Case& one : cases)
        for (Scheme scheme : {Scheme::heun, Scheme::euler, Scheme::implicit}) {
            const std::string said = advance_with(one.change, scheme);
            EXPECT_NE(said.find(one.says), std::string::npos) << said;
        }
}

TEST(Faults, AnOverlapBeyondTheLimitIsNamed)
{
    State s;
    s.box.length = Vec3(12, 12, 12);
    s.radius = {1, 1, 1};
    s.position = {Vec3(2, 2, 2), Vec3(8, 8, 8), Vec3(8, 8, 9.71)};
    const auto evaluated = [&] {
        Workspace workspace;
        evaluate(s, {}, ImposedStress{1}, workspace);
    };
    EXPECT_EQ(error_of(evaluated), "no error");  // xi = -0.29
    EXPECT_NO_THROW(check_overlaps(s));
    s.position[2].z() = 9.69;
    EXPECT_EQ(error_of(evaluated),
              "particles 1 and 2 overlap by 0.31 of their mean radius, the limit is 0.3");
    EXPECT_SAYS(check_overlaps(s), "particles 1 and 2 overlap by 0.31");
    s.position[2] = s.position[1];
    EXPECT_SAYS(evaluated(), "centres of particles 1 and 2 coincide");
}

// Spheres without springs are pressed into each other until the run stops.
TEST(Faults, ARunThatPressesSpheresIntoEachOtherStops)
{
    for (const Scene& scene : scenes) {
        SCOPED_TRACE(scene.name);
        Flow run = flow_of(scene);
        run.model.normal_stiffness = run.model.tangential_stiffness = 0;
        run.model.rolling_stiffness = 0;
        run.model.repulsion = 0;
        run.model.lubrication_delta = 1;
        run.stepping.displacement = 0.05;
        State last;
        const auto go_on = [&] {
            for (int k = 0; k < 2000; ++k) {
                last = run.state;
                run.advance_once();
            }
        };
        EXPECT_SAYS(go_on(), "the limit is 0.3");
        EXPECT_TRUE(same_bits(run.state, last));
        EXPECT_NO_THROW(check_overlaps(last));
    }
}

TEST(Faults, ParticlesThatNothingHoldsHaveNoVelocity)
{
    State s;
    s.box.length = Vec3(50, 50, 50);
    s.radius = {1, 1};
    s.position = {Vec3(2, 2, 2), Vec3(28, 28, 28)};
    Model m;
    m.drag_factor = 0;
    for (SolverKind kind : {SolverKind::pcg, SolverKind::cholesky, SolverKind::lagged_cholesky}) {
        Workspace workspace({kind});
        const State before = s;
        EXPECT_SAYS(evaluate_in_detail(s, m, ImposedStress{1}, workspace), "not positive definite");
        if (kind != SolverKind::pcg)  // which sees that there is nothing to solve
            EXPECT_SAYS(evaluate(s, m, ImposedStress{1}, workspace), "not positive definite");
        EXPECT_TRUE(same_bits(s, before));
    }
}

TEST(Faults, StepsThatVanishOrGoNowhereAreRefused)
{
    Flow run = flow_of(scenes[0]);
    run.model.tangential_stiffness = 1e20;
    EXPECT_SAYS(run.advance_once(), "time step vanishes");
    State lonely;
    lonely.box.length = Vec3(50, 50, 50);
    lonely.radius = {1};
    lonely.position = {Vec3(2, 2, 2)};
    Workspace workspace;
    Model m;
    m.stiffness_scale = StiffnessScale::fixed;
    m.tangential_stiffness = 0;
    EXPECT_SAYS(advance(lonely, m, ImposedRate{0}, {}, {}, workspace), "nothing moves");
}

}
