#include "engine/step.h"

#include "engine/error.h"

#include <algorithm>
#include <cmath>

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
std::vector<Contact> moved_contacts(const State& moved, const std::vector<Stage>& stages,
                                    Workspace& workspace)
{
    const Evaluation& first = *stages.front().evaluation;
    const Stiffness k = stiffness(first.model, first.control);
    std::vector<std::size_t> hints(stages.size(), 0);
    std::vector<Contact> contacts;
    for (const Pair& pair : touching_pairs(moved, first.model, workspace)) {
        Contact memory{pair.i, pair.j};
        for (std::size_t s = 0; s < stages.size(); ++s) {
            const Evaluation& e = *stages[s].evaluation;
            const int c = find_contact(e, pair.i, pair.j, hints[s]);
            if (c < 0) continue;
            const Vec3& from = e.pairs[e.contacts[c].pair].pair.normal;
            Vec3 spring = stages[s].dt * e.motion[c].slip,
                 rolling = stages[s].dt * e.motion[c].roll;
            if (s == 0) {
                spring += e.contacts[c].memory.spring;
                rolling += e.contacts[c].memory.rolling;
                memory.sliding = e.contacts[c].memory.sliding;
            }
            memory.spring += carried(spring, from, pair.normal);
            memory.rolling += carried(rolling, from, pair.normal);
        }
        contacts.push_back(
            contact_load(pair, moved.radius[pair.i], moved.radius[pair.j], memory, first.model, k)
                .memory);
    }
    return contacts;
}

// `start` moved by the velocities of the stages; positions are not wrapped, so that every stage
// sees the same images.
State moved(const State& start, const std::vector<Stage>& stages, Workspace& workspace)
{
    State result = start;
    for (const Stage& stage : stages) {
        const Velocities v = total_velocities(*stage.state, *stage.evaluation);
        for (int i = 0; i < start.size(); ++i) result.position[i] += stage.dt * v[i].head<3>();
        const double strain = stage.evaluation->shear_rate * stage.dt;
        result.box.offset += strain * start.box.length.y();
        result.strain += strain;
        result.time += stage.dt;
    }
    result.contacts = moved_contacts(result, stages, workspace);
    return result;
}

double stage_time(March march, double h, double rate)
{
    return march == March::strain ? h / rate : h;
}

}

void step(State& state, const Model& model, const Control& control, Scheme scheme, March march,
          double h, const Evaluation& first, Workspace& workspace)
{
    const double dt = stage_time(march, h, first.shear_rate);
    State next = moved(state, {{&first, &state, dt}}, workspace);
    if (scheme == Scheme::heun) {
        const Evaluation second = evaluate(next, model, control, workspace);
        const double dt2 = stage_time(march, h, second.shear_rate);
        next = moved(state, {{&first, &state, dt / 2}, {&second, &next, dt2 / 2}}, workspace);
    }
    if (march == March::strain) next.strain = state.strain + h;
    wrap(next.box, next.position);
    state = std::move(next);
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

void advance(State& state, const Model& model, const Control& control, const Stepping& stepping,
             const StepLimit& limit, const Evaluation& first, Workspace& workspace)
{
    double dt =
        std::min(displacement_time_step(first, stepping.displacement), stable_time_step(first));
    if (!std::isfinite(dt)) throw Error(ErrorKind::numerics, "", "nothing moves: no time step");
    // the last two steps before a limit are made equal rather than leaving a sliver
    const auto shortened = [](double h, double left) {
        return left <= h ? left : left < 2 * h ? left / 2 : h;
    };
    dt = shortened(dt, limit.time - state.time);
    const double left = limit.strain - state.strain, rate = first.shear_rate;
    if (rate * dt >= left) {
        // strain marching lands exactly unless the rate changes much within the step
        State landed = state;
        try {
            step(landed, model, control, stepping.scheme, March::strain, left, first, workspace);
        } catch (const Error&) {
            landed.time = std::numeric_limits<double>::quiet_NaN();
        }
        const double took = landed.time - state.time;
        if (took > 0.5 * left / rate && took < 2 * left / rate) {
            state = std::move(landed);
            return;
        }
        dt = left / rate;
    } else if (rate > 0) {
        dt = shortened(rate * dt, left) / rate;
    }
    step(state, model, control, stepping.scheme, March::time, dt, first, workspace);
}

}
