#include "engine/power_balance.h"

#include "engine/ambient.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow {

using lubrication::PairLoad;

namespace {

double power(const PairLoad& load, const PairVelocities& v)
{
    return load.force_i.dot(v.i.head<3>()) + load.torque_i.dot(v.i.tail<3>()) +
           load.force_j.dot(v.j.head<3>()) + load.torque_j.dot(v.j.tail<3>());
}

// Torques use radii instead of lever arms, so a pair load has a small net torque in the ambient
// spin.
double spin_residual(const PairLoad& load, const Pair& pair, double rate)
{
    const Vec3 net = load.torque_i + load.torque_j - pair.separation.cross(load.force_i);
    return -0.5 * rate * net.z();
}

void add_pair_power(const State& s, const Evaluation& e, const PairState& p, PowerBalance& balance)
{
    const PairVelocities total = moving(s, e, p.pair);
    const Vec3 force = -p.repulsion * p.pair.normal;
    const PairLoad repulsive{force, Vec3::Zero(), -force, Vec3::Zero()};
    balance.repulsion -= power(repulsive, total);
    balance.torque_residual += spin_residual(repulsive, p.pair, e.shear_rate);
    if (p.dashpot) {
        const PairLoad load = dashpot_load(s, e, p);
        balance.dashpot -= power(load, total);
        balance.torque_residual += spin_residual(load, p.pair, e.shear_rate);
        return;
    }
    const PairVelocities v{e.nonaffine[p.pair.i], e.nonaffine[p.pair.j]};
    const Mat3 E = e.shear_rate * unit_strain_rate();
    const auto r = resistance(s, p);
    const auto stresslet = lubrication::strain_stresslet(r, p.pair.normal, E);
    balance.lubrication += power(lubrication::resistance_times(r, p.pair.normal, v.i, v.j), v) -
                           2 * power(lubrication::strain_load(r, p.pair.normal, E), v) +
                           (stresslet.on_i + stresslet.on_j).cwiseProduct(E).sum();
}

/// A tangential spring of constant `stiffness` with a force, at its limit or not.
struct SpringPower {
    double stored, dissipated;
};

/// The limit grows by `limit_rate`; a spring at its limit can store no more than that.
SpringPower split(double power, double force, bool at_limit, double limit_rate, double stiffness)
{
    if (!at_limit) return {power, 0};
    const double stored = std::min(power, force * limit_rate / stiffness);
    return {stored, power - stored};
}

}

PowerBalance power_balance(const State& state, const DetailedEvaluation& d)
{
    const Evaluation& e = d.evaluation;
    PowerBalance balance;
    const double volume = state.box.volume();
    balance.input = volume * e.shear_rate * d.total_stress()(flow, gradient);
    balance.solvent = volume * e.shear_rate * d.stress[solvent](flow, gradient);
    for (int i = 0; i < state.size(); ++i)
        balance.drag += drag(state, e.model, i).dot(e.nonaffine[i].cwiseAbs2());
    for (const PairState& p : e.pairs) add_pair_power(state, e, p, balance);
    for (const ContactLoad& c : e.contacts) {
        const Pair& pair = c.pair;
        const PairLoad load{c.force_on_i, c.torque_on_i, -c.force_on_i, c.torque_on_j};
        balance.contact -= power(load, moving(state, e, pair));
        balance.torque_residual += spin_residual(load, pair, e.shear_rate);
    }
    return balance;
}

ContactPower contact_power(const State& state, const Evaluation& e)
{
    constexpr double limit_tolerance = 1e-9;  // as the friction law, which keeps |F_t| at the limit
    const Stiffness k = stiffness(e.model, e.control);
    ContactPower result;
    for (std::size_t c = 0; c < e.contacts.size(); ++c) {
        const ContactLoad& contact = e.contacts[c];
        const Pair& pair = contact.pair;
        const double mean = (state.radius[pair.i] + state.radius[pair.j]) / 2;
        const double scale = reference_force * mean;
        const PairVelocities v = moving(state, e, pair);
        const double closing = (v.i - v.j).head<3>().dot(pair.normal);
        const double load_rate = scale * k.normal * closing;
        result.normal_springs += contact.load * closing;
        const double friction = contact.friction.norm();
        if (friction > 0) {
            const SpringPower t =
                split(contact.friction.dot(e.motion[c].slip), friction, contact.memory.sliding,
                      e.model.friction_dynamic * load_rate, scale * k.tangential);
            result.tangential_springs += t.stored;
            result.sliding += t.dissipated;
        }
        const double moment = scale * k.rolling * contact.memory.rolling.norm();
        if (moment > 0) {
            const double load =
                std::max(contact.load - reference_force * e.model.critical_load, 0.);
            const double limit = e.model.rolling_friction * load;
            const SpringPower rolling =
                split(scale * k.rolling * contact.memory.rolling.dot(e.motion[c].roll), moment,
                      moment > (1 - limit_tolerance) * limit, e.model.rolling_friction * load_rate,
                      scale * k.rolling);
            result.tangential_springs += rolling.stored;
            result.sliding += rolling.dissipated;
        }
    }
    return result;
}

Power evaluate_power(const State& state, const Model& model, const Control& control,
                     Workspace& workspace)
{
    const DetailedEvaluation d = evaluate_in_detail(state, model, control, workspace);
    const PowerBalance balance = power_balance(state, d);
    const ContactPower contacts = contact_power(state, d.evaluation);
    Power p;
    p.strain = state.strain;
    p.shear_rate = d.evaluation.shear_rate;
    const auto* stress = std::get_if<ImposedStress>(&control);
    p.input = stress ? stress->value * p.shear_rate * state.box.volume() : balance.input;
    p.solvent = balance.solvent;
    p.lubrication = balance.lubrication;
    p.drag = balance.drag;
    p.dashpots = balance.dashpot;
    p.sliding = contacts.sliding;
    p.normal_springs = contacts.normal_springs;
    p.tangential_springs = contacts.tangential_springs;
    p.repulsion = balance.repulsion;
    p.torque_residual = balance.torque_residual;
    double sum = 0, largest = std::abs(p.input);
    for (const PowerField& field : power_fields()) {
        sum += p.*field.value;
        largest = std::max(largest, std::abs(p.*field.value));
    }
    p.residual = largest > 0 ? (p.input - sum) / largest : 0;
    return p;
}

std::span<const PowerField> power_fields()
{
    static constexpr PowerField fields[] = {
        {"solvent", "dissipated by the solvent, with 5/2 phi if on", &Power::solvent, false},
        {"lubrication", "dissipated by lubrication", &Power::lubrication, false},
        {"drag", "dissipated by Stokes drag", &Power::drag, false},
        {"dashpots", "dissipated by dashpots of contacts", &Power::dashpots, false},
        {"sliding", "dissipated by sliding friction, rolling friction included", &Power::sliding,
         false},
        {"normal_springs", "stored in normal springs", &Power::normal_springs, true},
        {"tangential_springs", "stored in tangential and rolling springs",
         &Power::tangential_springs, true},
        {"repulsion", "stored in the repulsion", &Power::repulsion, true},
        {"torque_residual", "of contact torques, which use radii instead of lever arms",
         &Power::torque_residual, true},
    };
    return fields;
}

}
