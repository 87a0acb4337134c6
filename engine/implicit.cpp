// The implicit step of step.h.
#include "engine/ambient.h"
#include "engine/checks.h"
#include "engine/lean_resize.h"
#include "engine/motion.h"
#include "engine/step.h"

#include <array>

namespace sigmaflow {

namespace {

/// Weights of the last step's mean motion and of the motion at the end of this step in the mean
/// motion of this step; ratio: its length over the last one's.
struct Weights {
    double past, end;
};

Weights weights(double ratio)
{
    return {ratio / (1 + 2 * ratio), (1 + ratio) / (1 + 2 * ratio)};
}

// Mean motion of a step as seen from its end, where the particles have come `to`, not wrapped.
// Relative to the flow at those positions it does not change when they are wrapped.
void find_mean(const Evaluation& past, const State& start, const Evaluation& end,
               const State& stage, const Weights& w, const State& to, int threads, Evaluation& mean)
{
    mean.shear_rate = w.past * past.shear_rate + w.end * end.shear_rate;
    mean.nonaffine.resize(start.size());
    for_each(threads, start.position.size(), [&](int i) {
        mean.nonaffine[i] = w.past * past.nonaffine[i] + w.end * end.nonaffine[i];
        mean.nonaffine[i].x() += w.past * past.shear_rate * start.position[i].y() +
                                 w.end * end.shear_rate * stage.position[i].y() -
                                 mean.shear_rate * to.position[i].y();
    });
}

// The step that led to a state, or one of no length that knows the contacts only.
PastStep& past_of(const State& state, const Model& model, const Control& control,
                  Workspace::Buffers& b)
{
    for (PastStep& past : b.past)
        if (past.time == state.time && past.mean.contacts.size() == state.contacts.size() &&
            past.mean.nonaffine.size() == state.position.size())
            return past;
    PastStep& none = b.past[0];
    none.time = -1;
    none.dt = 0;
    none.mean = prepare(state, model, control, nullptr, b);
    none.mean.shear_rate = 0;
    none.mean.nonaffine.assign(state.size(), Vec6::Zero());
    none.mean.motion.assign(none.mean.contacts.size(), {Vec3::Zero(), Vec3::Zero()});
    return none;
}

// Velocities at the end of a step as far as they can be foreseen; returns the shear rate.
double foresee(const State& state, const Model& model, const Control& control, double dt,
               Workspace& workspace)
{
    Workspace::Buffers& b = workspace.buffers();
    const double rate = b.history.guess(state.time + dt, state.size(), b.threads, b.foreseen);
    if (!b.foreseen.empty()) return rate;
    Evaluation now = evaluate(state, model, control, workspace);
    b.foreseen = now.nonaffine;
    const double known = now.shear_rate;
    recycle(std::move(now), workspace);
    return known;
}

}

Evaluation implicit_step(State& state, const Model& model, const Control& control, double dt,
                         double strain_limit, Workspace& workspace)
{
    Workspace::Buffers& b = workspace.buffers();
    PastStep& past = past_of(state, model, control, b);
    PastStep& here = &past == &b.past[0] ? b.past[1] : b.past[0];
    State &predicted = b.moved[0], &next = b.moved[1];
    const Evaluation& before = past.mean;
    const Weights w = past.dt > 0 ? weights(dt / past.dt) : Weights{0, 1};

    const double rate = foresee(state, model, control, dt, workspace);
    lean_resize(b.foreseen_motion, before.contacts.size());
    for_each(b.threads, before.contacts.size(), [&](int c) {
        const Pair& pair = before.contacts[c].pair;
        b.foreseen_motion[c] = relative_motion(state, moving(state, b.foreseen, rate, pair), pair);
    });
    const std::array foreseen{
        stage_of(before, state, w.past * dt),
        Stage{b.foreseen, rate, before.contacts, b.foreseen_motion, state, w.end * dt}};
    shift(state, foreseen, b.threads, predicted);
    move_contacts(foreseen, model, control, predicted, b);

    Evaluation end = evaluate_implicitly(
        predicted, model, control, {w.end * dt, &b.foreseen, rate, &b.friction_share}, workspace);

    const double mean_rate = w.past * before.shear_rate + w.end * end.shear_rate;
    const double left = strain_limit - state.strain;
    const bool passes = mean_rate * dt > left && mean_rate * dt * 0.9 < left;
    const double time = passes ? left / mean_rate : dt;
    const std::array found{stage_of(before, state, w.past * time),
                           stage_of(end, predicted, w.end * time)};
    shift(state, found, b.threads, next);
    here.time = -1;  // until it is complete
    find_mean(before, state, end, predicted, w, next, b.threads, here.mean);
    wrap(next.box, next.position);
    move_contacts(found, model, control, next, b, &here.mean);
    if (passes) next.strain = strain_limit;
    check_clock(next);
    here.time = next.time;
    here.dt = time;
    std::swap(state, next);
    return end;
}

}
