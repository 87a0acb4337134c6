#include "engine/evaluation.h"

#include "engine/ambient.h"
#include "engine/checks.h"
#include "engine/error.h"
#include "engine/lean_resize.h"
#include "engine/workspace.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow {

using lubrication::PairLoad;

bool uses_dashpot(const Model& m)
{
    return m.contact_hydrodynamics == ContactHydrodynamics::dashpot;
}

double interaction_range(const Model& m)
{
    return std::max(m.lubrication_range, m.repulsion_range);
}

PairLoad dashpot_unit_load(const State& s, const PairState& p)
{
    const auto [vi, vj] = with_image({ambient(s, p.pair.i), ambient(s, p.pair.j)}, p.pair, s, 1);
    return negative(lubrication::resistance_times(resistance(s, p), p.pair.normal, vi, vj));
}

void add(Velocities& loads, const Pair& pair, const PairLoad& load)
{
    loads[pair.i].head<3>() += load.force_i;
    loads[pair.i].tail<3>() += load.torque_i;
    loads[pair.j].head<3>() += load.force_j;
    loads[pair.j].tail<3>() += load.torque_j;
}

void remove_drift(const State& s, Velocities& v)
{
    Vec3 drift = Vec3::Zero();
    double weight = 0;
    for (int i = 0; i < s.size(); ++i) {
        drift += s.radius[i] * v[i].head<3>();
        weight += s.radius[i];
    }
    for (Vec6& one : v) one.head<3>() -= drift / weight;
}

double solvent_resistance(const State& s, const Model& m)
{
    return s.box.volume() * (m.einstein ? 1 + 2.5 * volume_fraction(s) : 1.);
}

namespace {

// b = fixed + rate * unit
void combine(const SlicedVector& fixed, double rate, const SlicedVector& unit, SlicedVector& sum)
{
    sum.resize(fixed.size());
    for (std::size_t k = 0; k < sum.size(); ++k)
        for (int c = 0; c < 6; ++c) sum[k].c[c] = fixed[k].c[c] + rate * unit[k].c[c];
}

// The solver refuses what is not finite, too, but does not know where it comes from.
void check_loads(const SlicedVector& load, const Evaluation& e)
{
    if (!all_finite(reinterpret_cast<const double*>(load.data()), load.size() * sizeof(Slice6) / sizeof(double)))
        check_forces(e.contacts);
}

void check_velocities(const Velocities& v)
{
    if (v.empty() || all_finite(v.front().data(), 6 * v.size())) return;
    int i = 0;
    while (v[i].allFinite()) ++i;
    throw Error(ErrorKind::numerics, "",
                "the velocity of particle " + std::to_string(i) + " is not finite");
}

// Volume times the shear stress x F of the dashpots at velocities V + rate U_inf.
double dashpot_moment(const State& s, const Evaluation& e, const Velocities& v, double rate)
{
    double sum = 0;
    for (const PairState& p : e.pairs) {
        if (!p.dashpot) continue;
        const PairVelocities w = with_image(
            {v[p.pair.i] + rate * ambient(s, p.pair.i), v[p.pair.j] + rate * ambient(s, p.pair.j)},
            p.pair, s, rate);
        const Vec3 force =
            -lubrication::resistance_times(resistance(s, p), p.pair.normal, w.i, w.j).force_i;
        sum += sym(p.pair.separation, force)(flow, gradient);
    }
    return sum;
}

double dot(const Velocities& u, const Velocities& v)
{
    double sum = 0;
    for (std::size_t i = 0; i < u.size(); ++i) sum += u[i].dot(v[i]);
    return sum;
}

// Stress control with dashpots: a solution per unit rate and one that is free of the rate.
void solve_twice(const State& s, const Loads& loads, Workspace& workspace, Evaluation& e)
{
    Workspace::Buffers& b = workspace.buffers();
    // here the error of the rate is linear in that of the solutions
    constexpr double share = 0.1;
    check_loads(b.fixed_load, e);
    e.solve = b.solver.solve({b.matrix}, b.unit_load, b.solution, share);
    const SolveReport second = b.solver.solve({b.matrix}, b.fixed_load, b.other_solution, share);
    e.solve.iterations += second.iterations;
    e.solve.residual = std::max(e.solve.residual, second.residual);
    e.solve.fell_back = e.solve.fell_back || second.fell_back;
    Velocities unit_velocity, fixed_velocity;
    from_slices(b.solution, b.slices, unit_velocity);
    from_slices(b.other_solution, b.slices, fixed_velocity);
    if (!e.model.background_drag) {
        remove_drift(s, unit_velocity);
        remove_drift(s, fixed_velocity);
    }
    // R_SU holds the pairs with a gap: their load per unit rate is that of the strain alone
    list_pairs(s, e, workspace);
    Velocities strain_load(s.size(), Vec6::Zero());
    for (const PairState& p : e.pairs)
        if (!p.dashpot)
            add(strain_load, p.pair,
                lubrication::strain_load(resistance(s, p), p.pair.normal, unit_strain_rate()));
    const double unit =
        loads.affine - dot(strain_load, unit_velocity) + dashpot_moment(s, e, unit_velocity, 1);
    const double fixed = loads.first_moment - dot(strain_load, fixed_velocity) +
                         dashpot_moment(s, e, fixed_velocity, 0);
    e.shear_rate = (std::get<ImposedStress>(e.control).value * s.box.volume() - fixed) / unit;
    e.nonaffine = std::move(fixed_velocity);
    for (std::size_t i = 0; i < e.nonaffine.size(); ++i)
        e.nonaffine[i] += e.shear_rate * unit_velocity[i];
}

}

void solve_at_once(const State& s, const Loads& loads, SolutionHistory& history,
                   Workspace::Buffers& b, Evaluation& e, double share)
{
    check_loads(b.fixed_load, e);
    history.guess(s.time, s.size(), b.threads, b.guess);
    if (b.guess.empty())
        b.solution.assign(b.slices.count + 1, Slice6{});
    else
        to_slices(b.guess, b.slices, b.solution, b.threads);
    if (const auto* rate = std::get_if<ImposedRate>(&e.control)) {
        e.shear_rate = rate->value;
        combine(b.fixed_load, rate->value, b.unit_load, b.right);
        e.solve = b.solver.solve({b.matrix}, b.right, b.solution, share);
    } else {
        const double free =
            std::get<ImposedStress>(e.control).value * s.box.volume() - loads.first_moment;
        combine(b.fixed_load, free / loads.affine, b.unit_load, b.right);
        e.solve =
            b.solver.solve({b.matrix, &b.unit_load, 1 / loads.affine}, b.right, b.solution, share);
        e.shear_rate = (free + dot(b.unit_load, b.solution)) / loads.affine;
    }
    from_slices(b.solution, b.slices, e.nonaffine, b.threads);
    if (!e.model.background_drag) remove_drift(s, e.nonaffine);
    check_scalar(e.shear_rate, "the shear rate");  // the residual has answered for the velocities
    history.remember(s.time, e.nonaffine, e.shear_rate);
}

void complete(const State& state, int threads, Evaluation& e)
{
    check_scalar(e.shear_rate, "the shear rate");
    check_velocities(e.nonaffine);
    lean_resize(e.motion, e.contacts.size());
    for_each(threads, e.contacts.size(),
             [&](int c) { e.motion[c] = relative_motion(state, e, e.contacts[c].pair); });
}

Evaluation evaluate(const State& state, const Model& model, const Control& control,
                    Workspace& workspace)
{
    Workspace::Buffers& b = workspace.buffers();
    Evaluation e = prepare(state, model, control, nullptr, b);
    const Loads loads = assemble_loads(state, e, b);
    if (uses_dashpot(model) && std::holds_alternative<ImposedStress>(control))
        solve_twice(state, loads, workspace, e);
    else
        solve_at_once(state, loads, b.history, b, e);
    complete(state, b.threads, e);
    return e;
}

Evaluation evaluate_implicitly(const State& state, const Model& model, const Control& control,
                               const ImplicitStage& stage, Workspace& workspace)
{
    if (uses_dashpot(model))
        throw Error(ErrorKind::input, "contact_hydrodynamics",
                    "\"dashpot\" cannot be used with the scheme \"implicit\"");
    Workspace::Buffers& b = workspace.buffers();
    Evaluation e = prepare(state, model, control, &stage, b);
    solve_at_once(state, assemble_loads(state, e, b), b.history, b, e);
    complete(state, b.threads, e);
    return e;
}

Velocities total_velocities(const State& state, const Evaluation& e)
{
    Velocities v(state.size());
    for (int i = 0; i < state.size(); ++i) v[i] = e.nonaffine[i] + e.shear_rate * ambient(state, i);
    return v;
}

ContactMotion relative_motion(const State& s, const Evaluation& e, const Pair& pair)
{
    return relative_motion(s, moving(s, e, pair), pair);
}

lubrication::PairResistance resistance(const State& s, const PairState& p)
{
    return lubrication::scaled(
        lubrication::pair_coefficients(s.radius[p.pair.i], s.radius[p.pair.j]), p.factors.L,
        p.factors.l);
}

}
