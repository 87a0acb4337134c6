#include "engine/step.h"

#include "engine/ambient.h"
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
    b.friction_share.clear();
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
        const double stretch = memory.spring.norm();
        moved.contacts.push_back(
            contact_load(pair, moved.radius[pair.i], moved.radius[pair.j], memory, first.model, k)
                .memory);
        const Contact& limited = moved.contacts.back();
        b.friction_share.push_back(limited.sliding ? limited.spring.norm() / stretch : 1);
    }
}

// Particles and box of `start` moved by the velocities of the stages, not wrapped.
void shift(const State& start, std::initializer_list<Stage> stages, State& result)
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
}

// `start` moved by the velocities of the stages. The positions of a stage within a step are not
// wrapped, so that every stage sees the same images; those at its end are.
void move(const State& start, std::initializer_list<Stage> stages, bool wrapped, State& result,
          Workspace::Buffers& b)
{
    shift(start, stages, result);
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

namespace {

/// Weights of the last step's mean motion and of the motion at the end of this one in the mean
/// motion of this one; ratio: this step's length over the last one's.
struct Weights {
    double past, end;
};
Weights bdf2(double ratio)
{
    return {ratio / (1 + 2 * ratio), (1 + ratio) / (1 + 2 * ratio)};
}

// Mean motion of a step as seen from its end, where the particles have come `to`, unwrapped.
void find_mean(const State& start, const Evaluation& past, const State& stage,
               const Evaluation& end, const Weights& w, const State& to, Evaluation& mean)
{
    mean.model = end.model;
    mean.control = end.control;
    mean.shear_rate = w.past * past.shear_rate + w.end * end.shear_rate;
    mean.nonaffine.resize(start.size());
    for (int i = 0; i < start.size(); ++i) {
        mean.nonaffine[i] = w.past * past.nonaffine[i] + w.end * end.nonaffine[i];
        mean.nonaffine[i].x() += w.past * past.shear_rate * start.position[i].y() +
                                 w.end * end.shear_rate * stage.position[i].y() -
                                 mean.shear_rate * to.position[i].y();
    }
}

// The contacts at the end of a step and the mean of their slip velocities.
void find_mean_slip(const State& to, const Evaluation& past, const Evaluation& end,
                    const Weights& w, const Workspace::Buffers& b, Evaluation& mean)
{
    std::size_t past_hint = 0, end_hint = 0;
    mean.contacts.resize(to.contacts.size());
    mean.motion.resize(to.contacts.size());
    for (std::size_t k = 0; k < to.contacts.size(); ++k) {
        ContactLoad& c = mean.contacts[k];
        c.pair = touching_pair(to, b, k);
        c.memory = to.contacts[k];
        ContactMotion& m = mean.motion[k];
        m = {Vec3::Zero(), Vec3::Zero()};
        const auto add = [&](const Evaluation& e, double weight, std::size_t& hint) {
            const int found = find_contact(e, c.pair.i, c.pair.j, hint);
            if (found < 0) return;
            const Vec3& from = e.contacts[found].pair.normal;
            m.slip += weight * carried(e.motion[found].slip, from, c.pair.normal);
            m.roll += weight * carried(e.motion[found].roll, from, c.pair.normal);
        };
        add(past, w.past, past_hint);
        add(end, w.end, end_hint);
    }
}

/// What is known of the motion up to a state: that of the last step, or nothing but the contacts.
struct Past {
    const Evaluation* mean;
    double dt;  // 0: unknown
};

Past past_of(const State& state, const Model& model, const Control& control, Workspace::Buffers& b)
{
    for (const PastStep& past : b.past)
        if (past.time == state.time &&
            past.mean.contacts.size() == state.contacts.size() &&
            past.mean.nonaffine.size() == state.position.size())
            return {&past.mean, past.dt};
    // no step led here: a motion of no weight, with the contacts of the state
    Evaluation& none = b.past[0].mean;
    b.past[0].time = -1;
    none = prepare(state, model, control, nullptr, b);
    none.shear_rate = 0;
    none.nonaffine.assign(state.size(), Vec6::Zero());
    none.motion.assign(none.contacts.size(), {Vec3::Zero(), Vec3::Zero()});
    return {&none, 0};
}

}

Evaluation implicit_step(State& state, const Model& model, const Control& control, double dt,
                         double strain_limit, Workspace& workspace)
{
    Workspace::Buffers& b = workspace.buffers();
    State &stage = b.moved[0], &next = b.moved[1];
    const Past past = past_of(state, model, control, b);
    const Weights w = past.dt > 0 ? bdf2(dt / past.dt) : Weights{0, 1};
    PastStep& here = past.mean == &b.past[0].mean ? b.past[1] : b.past[0];

    // predicted motion, from the velocities extrapolated to the end of the step
    double rate = b.history.guess(state.time + dt, b.predicted);
    if (b.predicted.empty()) {
        Evaluation start = evaluate(state, model, control, workspace);
        b.predicted = start.nonaffine;
        rate = start.shear_rate;
        recycle(std::move(start), workspace);
    }
    Evaluation& predicted = here.mean;
    predicted.model = model;
    predicted.control = control;
    predicted.shear_rate = w.past * past.mean->shear_rate + w.end * rate;
    predicted.nonaffine.resize(state.size());
    for (int i = 0; i < state.size(); ++i)
        predicted.nonaffine[i] = w.past * past.mean->nonaffine[i] + w.end * b.predicted[i];
    predicted.contacts = past.mean->contacts;
    predicted.motion.clear();
    for (std::size_t c = 0; c < predicted.contacts.size(); ++c) {
        const Pair& pair = predicted.contacts[c].pair;
        const ContactMotion m =
            relative_motion(state, moving(state, b.predicted, rate, pair), pair);
        const ContactMotion& before = past.mean->motion[c];
        predicted.motion.push_back(
            {w.past * before.slip + w.end * m.slip, w.past * before.roll + w.end * m.roll});
    }
    move(state, {{&predicted, &state, dt}}, false, stage, b);

    Evaluation end = evaluate_implicitly(
        stage, model, control, {w.end * dt, &b.predicted, rate, &b.friction_share}, workspace);
    const double mean_rate = w.past * past.mean->shear_rate + w.end * end.shear_rate;
    const double left = strain_limit - state.strain;
    const bool passes = mean_rate * dt > left && mean_rate * dt * 0.9 < left;
    const double time = passes ? left / mean_rate : dt;
    shift(state, {{past.mean, &state, w.past * time}, {&end, &stage, w.end * time}}, next);
    find_mean(state, *past.mean, stage, end, w, next, here.mean);
    wrap(next.box, next.position);
    move_contacts({{past.mean, &state, w.past * time}, {&end, &stage, w.end * time}}, next, b);
    find_mean_slip(next, *past.mean, end, w, b, here.mean);
    if (passes) next.strain = strain_limit;
    here.time = next.time;
    here.dt = time;
    std::swap(state, next);
    return end;
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
    const double known_rate =
        first ? first->shear_rate : workspace.buffers().history.rate[0];
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
