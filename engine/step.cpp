#include "engine/step.h"

#include "engine/error.h"
#include "engine/workspace.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>

namespace sigmaflow {

namespace {

/// A stage of a step: its velocities act for the time dt (negative when the box goes back).
struct Stage {
    const Evaluation* evaluation;
    const State* state;
    double dt;
};

double longest_vector(const Evaluation& e)
{
    double square = 0;
    for (const Vec6& v : e.nonaffine) square = std::max(square, v.head<3>().squaredNorm());
    for (const ContactMotion& m : e.motion) square = std::max(square, m.slip.squaredNorm());
    return std::sqrt(square);
}

// The contact of pair (i, j) in an evaluation, or -1; `hint` walks along with sorted queries.
int find_contact(const Evaluation& e, int i, int j, std::size_t& hint)
{
    while (hint < e.contacts.size()) {
        const Contact& c = e.contacts[hint].memory;
        if (c.i < i || (c.i == i && c.j < j))
            ++hint;
        else
            return c.i == i && c.j == j ? static_cast<int>(hint) : -1;
    }
    return -1;
}

// Springs of the pairs that touch at the new positions: carried from the first stage, stretched by
// the weighted slip velocities, projected and limited by the friction law.
void move_contacts(std::initializer_list<Stage> stages, State& moved, Workspace::Buffers& b)
{
    const Evaluation& first = *stages.begin()->evaluation;
    const Stiffness k = stiffness(first.model, first.control);
    locate(moved, first.model, b);
    std::array<std::size_t, 2> hints{};
    moved.contacts.clear();
    for (std::size_t touch = 0; touch < b.touching.size(); ++touch) {
        const Pair pair = touching_pair(moved, b, touch);
        Contact memory{pair.i, pair.j};
        std::size_t* hint = hints.data();
        for (const Stage& stage : stages) {
            const Evaluation& e = *stage.evaluation;
            const int c = find_contact(e, pair.i, pair.j, *hint++);
            if (c < 0) continue;
            const Vec3& from = e.contacts[c].pair.normal;
            Vec3 spring = stage.dt * e.motion[c].slip, rolling = stage.dt * e.motion[c].roll;
            if (&stage == stages.begin()) {
                spring += e.contacts[c].memory.spring;
                rolling += e.contacts[c].memory.rolling;
                memory.sliding = e.contacts[c].memory.sliding;
            }
            memory.spring += carried(spring, from, pair.normal);
            memory.rolling += carried(rolling, from, pair.normal);
        }
        moved.contacts.push_back(
            contact_load(pair, moved.radius[pair.i], moved.radius[pair.j], memory, first.model, k)
                .memory);
    }
}

// `start` moved by the velocities of the stages. The positions of a stage within a step are not
// wrapped, so that every stage sees the same images; those at its end are.
void move(const State& start, std::initializer_list<Stage> stages, bool wrapped, State& result,
          Workspace::Buffers& b)
{
    result = start;
    for (const Stage& stage : stages) {
        const Evaluation& e = *stage.evaluation;
        const double strain = e.shear_rate * stage.dt;
        for (int i = 0; i < start.size(); ++i) {
            result.position[i] += stage.dt * e.nonaffine[i].head<3>();
            result.position[i].x() += strain * stage.state->position[i].y();
        }
        result.box.offset += strain * start.box.length.y();
        result.strain += strain;
        result.time += stage.dt;
    }
    if (wrapped) wrap(result.box, result.position);
    move_contacts(stages, result, b);
}

}

void step(State& state, const Model& model, const Control& control, Scheme scheme, March march,
          double h, const Evaluation& first, Workspace& workspace)
{
    Workspace::Buffers& b = workspace.buffers();
    State &stage = b.moved[0], &next = b.moved[1];
    const double dt = march == March::strain ? h / first.shear_rate : h;
    bool lands = march == March::strain;
    if (scheme == Scheme::heun) {
        move(state, {{&first, &state, dt}}, false, stage, b);
        Evaluation second = evaluate(stage, model, control, workspace);
        // a rate that collapses within the step would make the second stage endless
        lands = lands && second.shear_rate > 0.25 * first.shear_rate;
        const double dt2 = lands ? h / second.shear_rate : dt;
        move(state, {{&first, &state, dt / 2}, {&second, &stage, dt2 / 2}}, true, next, b);
        recycle(std::move(second), workspace);
    } else {
        move(state, {{&first, &state, dt}}, true, next, b);
    }
    if (lands) next.strain = state.strain + h;
    std::swap(state, next);
}

double displacement_time_step(const Evaluation& evaluation, double displacement)
{
    return displacement / std::max(std::abs(evaluation.shear_rate), longest_vector(evaluation));
}

double stable_time_step(const Evaluation& evaluation)
{
    const Stiffness k = stiffness(evaluation.model, evaluation.control);
    double dt = std::numeric_limits<double>::infinity();
    if (k.tangential > 0) dt = 25 / (reference_force * k.tangential);
    const double tau = evaluation.model.contact_relaxation_time;
    return tau > 0 ? std::min(dt, tau) : dt;
}

Evaluation implicit_step(State& state, const Model& model, const Control& control, double dt,
                         double strain_limit, Workspace& workspace)
{
    Workspace::Buffers& b = workspace.buffers();
    State &stage = b.moved[0], &next = b.moved[1];
    const double ahead = (1 - std::sqrt(0.5)) * dt;
    Evaluation first = evaluate_implicitly(state, model, control, {ahead, dt, nullptr}, workspace);
    move(state, {{&first, &state, dt}}, false, stage, b);
    Evaluation second = evaluate_implicitly(stage, model, control, {ahead, dt, &first}, workspace);
    const double rate = (first.shear_rate + second.shear_rate) / 2;
    const double left = strain_limit - state.strain;
    const bool passes = rate * dt > left && rate * dt * 0.9 < left;
    const double time = passes ? left / rate : dt;
    move(state, {{&first, &state, time / 2}, {&second, &stage, time / 2}}, true, next, b);
    if (passes) next.strain = strain_limit;
    recycle(std::move(first), workspace);
    std::swap(state, next);
    return second;
}

namespace {

// the last two steps before a limit are made equal rather than leaving a sliver
double shortened(double step, double left)
{
    return left <= step ? left : left < 2 * step ? left / 2 : step;
}

constexpr double growth = 1.3;         // largest ratio of successive implicit steps
constexpr double first_share = 0.05;   // of the displacement, in the first implicit step
constexpr double accepted_excess = 2;  // displacements; a step that moves more is undone

Evaluation advance_implicitly(State& state, const Model& model, const Control& control,
                              const Stepping& stepping, const StepLimit& limit,
                              Workspace& workspace, const Evaluation* first)
{
    double dt = state.time_step;
    if (dt == 0) {
        const Evaluation start = first ? *first : evaluate(state, model, control, workspace);
        dt = first_share * displacement_time_step(start, stepping.displacement);
    }
    const double known_rate = first ? first->shear_rate : workspace.buffers().last_rate;
    for (;;) {
        double h = shortened(dt, limit.time - state.time);
        const double left = limit.strain - state.strain;
        if (known_rate * h > 0.5 * left && known_rate > 0)
            // slightly too long: the step itself finds how much it needs to land
            h = std::min(h, 1.03 * shortened(known_rate * h, left) / known_rate);
        State next = state;
        Evaluation second = implicit_step(next, model, control, h, limit.strain, workspace);
        const double proposed = displacement_time_step(second, stepping.displacement);
        const bool passed = next.strain > limit.strain + 1e-12;
        if (h <= accepted_excess * proposed && !passed) {
            next.time_step = std::min(proposed, growth * dt);
            state = std::move(next);
            return second;
        }
        dt = passed ? 0.5 * h : std::max(0.2 * h, std::min(proposed, 0.5 * h));
        if (!(dt > 1e-14)) throw Error(ErrorKind::numerics, "", "the time step vanishes");
    }
}

}

Evaluation advance(State& state, const Model& model, const Control& control,
                   const Stepping& stepping, const StepLimit& limit, Workspace& workspace,
                   const Evaluation* known)
{
    if (stepping.scheme == Scheme::implicit)
        return advance_implicitly(state, model, control, stepping, limit, workspace, known);
    Evaluation first = known ? *known : evaluate(state, model, control, workspace);
    double dt =
        std::min(displacement_time_step(first, stepping.displacement), stable_time_step(first));
    if (!std::isfinite(dt)) throw Error(ErrorKind::numerics, "", "nothing moves: no time step");
    dt = shortened(dt, limit.time - state.time);
    const double left = limit.strain - state.strain, rate = first.shear_rate;
    if (rate * dt >= left) {
        step(state, model, control, stepping.scheme, March::strain, left, first, workspace);
        return first;
    }
    if (rate > 0) dt = shortened(rate * dt, left) / rate;
    step(state, model, control, stepping.scheme, March::time, dt, first, workspace);
    return first;
}

}
