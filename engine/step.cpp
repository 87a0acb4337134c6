#include "engine/step.h"

#include "engine/checks.h"
#include "engine/error.h"
#include "engine/motion.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sigmaflow {

namespace {

double longest_vector(const Evaluation& e)
{
    double square = 0;
    for (const Vec6& v : e.nonaffine) square = std::max(square, v.head<3>().squaredNorm());
    for (const ContactMotion& m : e.motion) square = std::max(square, m.slip.squaredNorm());
    return std::sqrt(square);
}

}

void step(State& state, const Model& model, const Control& control, Scheme scheme, March march,
          double h, const Evaluation& first, Workspace& workspace)
{
    Workspace::Buffers& b = workspace.buffers();
    State &stage = b.moved[0], &next = b.moved[1];
    const double dt = march == March::strain ? h / first.shear_rate : h;
    bool lands = march == March::strain;
    const auto arrive = [&](std::span<const Stage> stages) {
        shift(state, stages, b.threads, next);
        wrap(next.box, next.position);
        move_contacts(stages, model, control, next, b);
    };
    if (scheme == Scheme::heun) {
        const std::array whole{stage_of(first, state, dt)};
        shift(state, whole, b.threads, stage);
        move_contacts(whole, model, control, stage, b);
        Evaluation second = evaluate(stage, model, control, workspace);
        // a rate that collapses within the step would make the second stage endless
        lands = lands && second.shear_rate > 0.25 * first.shear_rate;
        const double dt2 = lands ? h / second.shear_rate : dt;
        arrive(std::array{stage_of(first, state, dt / 2), stage_of(second, stage, dt2 / 2)});
        recycle(std::move(second), workspace);
    } else {
        arrive(std::array{stage_of(first, state, dt)});
    }
    if (lands) next.strain = state.strain + h;
    check_clock(next);
    check_overlaps(b.touching_pairs);
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

// the last two steps before a limit are made equal rather than leaving a sliver
double shortened(double step, double left)
{
    return left <= step ? left : left < 2 * step ? left / 2 : step;
}

constexpr double growth = 1.3;         // largest ratio of successive implicit steps
constexpr double first_share = 0.05;   // of the displacement, in the first implicit step
constexpr double accepted_excess = 2;  // displacements; a step that moves more is undone
// Nothing else bounds the step of a suspension that comes to rest, and long steps would shake it
// before its springs have found their balance, which takes about 60 eta0/sigma.
constexpr double longest_step = 1;  // [eta0/sigma]

void check_time_step(double dt)
{
    if (!(dt > 1e-14)) throw Error(ErrorKind::numerics, "", "the time step vanishes");
}

double longest_time_step(const Control& control)
{
    const auto* stress = std::get_if<ImposedStress>(&control);
    return stress ? longest_step / stress->value : std::numeric_limits<double>::infinity();
}

Evaluation advance_implicitly(State& state, const Model& model, const Control& control,
                              const Stepping& stepping, const StepLimit& limit,
                              Workspace& workspace, const Evaluation* first)
{
    double dt = state.time_step;
    if (dt == 0) {
        const Evaluation start = first ? *first : evaluate(state, model, control, workspace);
        dt = first_share * displacement_time_step(start, stepping.displacement);
    }
    const double known_rate = first ? first->shear_rate : workspace.buffers().history.rate[0];
    for (;;) {
        double h = shortened(dt, limit.time - state.time);
        const double left = limit.strain - state.strain;
        if (known_rate * h > 0.5 * left && known_rate > 0)
            // slightly too long: the step itself finds how much it needs to land
            h = std::min(h, 1.03 * shortened(known_rate * h, left) / known_rate);
        State& next = workspace.buffers().trial;
        next = state;
        Evaluation second = implicit_step(next, model, control, h, limit.strain, workspace);
        const double proposed = displacement_time_step(second, stepping.displacement);
        const bool passed = next.strain > limit.strain + 1e-12;
        if (h <= accepted_excess * proposed && !passed) {
            check_overlaps(workspace.buffers().touching_pairs);
            next.time_step = std::min({proposed, growth * dt, longest_time_step(control)});
            std::swap(state, next);
            return second;
        }
        recycle(std::move(second), workspace);
        dt = passed ? 0.5 * h : std::max(0.2 * h, std::min(proposed, 0.5 * h));
        check_time_step(dt);
    }
}

}

Evaluation advance(State& state, const Model& model, const Control& control,
                   const Stepping& stepping, const StepLimit& limit, Workspace& workspace,
                   const Evaluation* known)
{
    check_model(model, control);
    check_state(state);
    if (stepping.scheme == Scheme::implicit)
        return advance_implicitly(state, model, control, stepping, limit, workspace, known);
    Evaluation first = known ? *known : evaluate(state, model, control, workspace);
    double dt =
        std::min(displacement_time_step(first, stepping.displacement), stable_time_step(first));
    if (!std::isfinite(dt)) throw Error(ErrorKind::numerics, "", "nothing moves: no time step");
    check_time_step(dt);
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
