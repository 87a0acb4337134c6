#include "engine/evaluation.h"

#include "engine/ambient.h"
#include "engine/error.h"
#include "engine/forces/repulsion.h"
#include "engine/workspace.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow {

using lubrication::PairLoad;

Workspace::Workspace(const SolverSettings& solver) : buffers_(std::make_unique<Buffers>(solver)) {}
Workspace::~Workspace() = default;
Workspace::Workspace(Workspace&&) noexcept = default;
Workspace& Workspace::operator=(Workspace&&) noexcept = default;

Velocities SolutionHistory::guess(double at) const
{
    if (known == 0) return {};
    const double interval = time[0] - time[1], ahead = at - time[0];
    // beyond a few intervals a straight line is worse than the last value
    if (known == 1 || ahead == 0 || !(std::abs(ahead) < 4 * std::abs(interval))) return solution[0];
    const double weight = ahead / interval;
    Velocities v(solution[0].size());
    for (std::size_t i = 0; i < v.size(); ++i)
        v[i] = solution[0][i] + weight * (solution[0][i] - solution[1][i]);
    return v;
}

void SolutionHistory::remember(double at, const Velocities& v)
{
    if (known > 0 && solution[0].size() != v.size()) known = 0;
    if (known > 0 && at != time[0]) {
        std::swap(solution[0], solution[1]);
        time[1] = time[0];
        known = 2;
    }
    known = std::max(known, 1);
    time[0] = at;
    solution[0] = v;
}

void recycle(Evaluation&& evaluation, Workspace& workspace)
{
    // a step needs two; copies that callers made must not pile up
    auto& spare = workspace.buffers().spare;
    if (spare.size() < 4) spare.push_back(std::move(evaluation));
}

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

void update_neighbours(const State& s, const Model& m, Workspace::Buffers& b)
{
    if (!b.neighbours.update(s, interaction_range(m))) return;
    const auto& candidates = b.neighbours.candidates();
    b.solver.set_pattern(s.size(), candidates);
    b.coefficients.clear();
    b.coefficients.reserve(candidates.size());
    for (const auto [i, j] : candidates) {
        const auto c = lubrication::pair_coefficients(s.radius[i], s.radius[j]);
        b.coefficients.push_back({c.xa, c.ya, c.yb11, c.yb21, c.yc11, c.yc12, c.yc22});
    }
}

PairState pair_state(const Pair& pair, const State& s, const Model& m, const Stiffness& k)
{
    PairState p{pair,
                {0, 0},
                repulsion(pair, s.radius[pair.i], s.radius[pair.j], m),
                pair.touching() && uses_dashpot(m)};
    if (pair.xi < m.lubrication_range) {
        p.factors = lubrication::gap_factors(pair.xi, m.lubrication_delta);
        if (pair.touching() && m.contact_relaxation_time > 0)
            p.factors.L = 4 * k.normal * m.contact_relaxation_time;
    }
    return p;
}

// Forces of all touching pairs; a pair without memory starts with relaxed springs, sticking.
void find_contact_loads(const State& s, const Stiffness& k, Evaluation& e)
{
    e.contacts.clear();
    auto memory = s.contacts.begin();
    for (std::size_t index = 0; index < e.pairs.size(); ++index) {
        const Pair& pair = e.pairs[index].pair;
        if (!pair.touching()) continue;
        while (memory != s.contacts.end() &&
               (memory->i < pair.i || (memory->i == pair.i && memory->j < pair.j)))
            ++memory;
        const bool known = memory != s.contacts.end() && memory->i == pair.i && memory->j == pair.j;
        e.contacts.push_back(contact_load(pair, s.radius[pair.i], s.radius[pair.j],
                                          known ? *memory : Contact{pair.i, pair.j}, e.model, k));
        e.contacts.back().pair = static_cast<int>(index);
    }
}

BlockCoefficients scaled(const BlockCoefficients& c, const lubrication::GapFactors& f)
{
    return {f.L * c.xa,   f.l * c.ya,   f.l * c.yb11, f.l * c.yb21,
            f.l * c.yc11, f.l * c.yc12, f.l * c.yc22};
}

double shear_moment(const Vec3& d, const Vec3& force)
{
    return 0.5 * (d.x() * force.y() + d.y() * force.x());
}

void add_block(ResistanceMatrix& matrix, const Pair& pair, const BlockCoefficients& c)
{
    const Vec3& n = pair.normal;
    add_pair(matrix.diagonal[pair.i], n, c.xa, c.ya, c.yb11, c.yc11);
    add_pair(matrix.diagonal[pair.j], n, c.xa, c.ya, -c.yb21, c.yc22);
    matrix.pairs.push_back({pair.i, pair.j, pair.candidate, n, c.xa, c.ya, c.yb11, c.yb21, c.yc12});
}

void assemble_matrix(const State& s, const Evaluation& e, Workspace::Buffers& b)
{
    ResistanceMatrix& matrix = b.matrix;
    matrix.diagonal.resize(s.size());
    for (int i = 0; i < s.size(); ++i) {
        const Vec6 own = drag(s, e.model, i);
        matrix.diagonal[i] = {{own[0], own[1], own[2]}, {own[3], own[4], own[5]}, {}};
    }
    matrix.pairs.clear();
    for (const PairState& p : e.pairs) {
        if (p.factors.L == 0) continue;  // repulsion alone
        add_block(b.matrix, p.pair, scaled(b.coefficients[p.pair.candidate], p.factors));
    }
}

}

// An affine flow acts only through the relative velocity r n.grad U, so that the sums over the
// resistance functions G, H, M that stress control needs are multiples of A and B (identities of
// the functions of Jeffrey & Onishi and Jeffrey, tested): Ehat:R_SE:Ehat = s^2 XA (n.e)^2 + s^2 YA
// (e.e - (n.e)^2).
AffineLoad affine_load(const State& s, const Pair& pair, const BlockCoefficients& c)
{
    const Vec3& n = pair.normal;
    const double sum = s.radius[pair.i] + s.radius[pair.j];
    const Vec3 strain(0.5 * n.y(), 0.5 * n.x(), 0);
    const double normal = n.x() * n.y();
    const Vec3 tangential = strain - normal * n, twist = strain.cross(n);
    const Vec3 force = sum * (c.xa * normal * n + c.ya * tangential);
    return {{force, sum * c.yb11 * twist, -force, sum * c.yb21 * twist},
            sum * sum * (c.xa * normal * normal + c.ya * tangential.squaredNorm())};
}

Loads assemble_loads(const State& s, const Evaluation& e, Workspace::Buffers& b)
{
    b.unit_load.assign(s.size(), Vec6::Zero());
    b.fixed_load.assign(s.size(), Vec6::Zero());
    Loads result;
    result.affine = solvent_resistance(s, e.model);
    for (const PairState& p : e.pairs) {
        const Vec3& n = p.pair.normal;
        if (p.repulsion != 0) {
            const Vec3 force = -p.repulsion * n;
            b.fixed_load[p.pair.i].head<3>() += force;
            b.fixed_load[p.pair.j].head<3>() -= force;
            result.first_moment += shear_moment(p.pair.separation, force);
        }
        if (p.dashpot) add(b.unit_load, p.pair, dashpot_unit_load(s, p));
        if (p.dashpot || p.factors.L == 0) continue;
        const AffineLoad affine =
            affine_load(s, p.pair, scaled(b.coefficients[p.pair.candidate], p.factors));
        add(b.unit_load, p.pair, affine.load);
        result.affine += affine.stress;
    }
    for (const ContactLoad& c : e.contacts) {
        const Pair& pair = e.pairs[c.pair].pair;
        add(b.fixed_load, pair, {c.force_on_i, c.torque_on_i, -c.force_on_i, c.torque_on_j});
        result.first_moment += shear_moment(pair.separation, c.force_on_i);
    }
    return result;
}

namespace {

// b = fixed + rate * unit
Velocities combined(const Velocities& fixed, double rate, const Velocities& unit)
{
    Velocities sum(fixed);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += rate * unit[i];
    return sum;
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

// Stress control with dashpots: a solution per unit rate and one that is free of the rate.
void solve_twice(const State& s, const Loads& loads, Workspace::Buffers& b, Evaluation& e)
{
    e.solve = b.solver.solve({b.matrix}, b.unit_load, b.unit_velocity);
    const SolveReport second = b.solver.solve({b.matrix}, b.fixed_load, b.fixed_velocity);
    e.solve.iterations += second.iterations;
    e.solve.residual = std::max(e.solve.residual, second.residual);
    e.solve.fell_back = e.solve.fell_back || second.fell_back;
    if (!e.model.background_drag) {
        remove_drift(s, b.unit_velocity);
        remove_drift(s, b.fixed_velocity);
    }
    // R_SU holds the pairs with a gap: their load per unit rate is that of the strain alone
    Velocities strain_load(s.size(), Vec6::Zero());
    for (const PairState& p : e.pairs)
        if (!p.dashpot)
            add(strain_load, p.pair,
                lubrication::strain_load(resistance(s, p), p.pair.normal, unit_strain_rate()));
    const double unit =
        loads.affine - dot(strain_load, b.unit_velocity) + dashpot_moment(s, e, b.unit_velocity, 1);
    const double fixed = loads.first_moment - dot(strain_load, b.fixed_velocity) +
                         dashpot_moment(s, e, b.fixed_velocity, 0);
    e.shear_rate = (std::get<ImposedStress>(e.control).value * s.box.volume() - fixed) / unit;
    e.nonaffine = combined(b.fixed_velocity, e.shear_rate, b.unit_velocity);
}

}

void solve_at_once(const State& s, const Loads& loads, SolutionHistory& history,
                   Workspace::Buffers& b, Evaluation& e)
{
    e.nonaffine = history.guess(s.time);
    if (const auto* rate = std::get_if<ImposedRate>(&e.control)) {
        e.shear_rate = rate->value;
        e.solve = b.solver.solve({b.matrix}, combined(b.fixed_load, rate->value, b.unit_load),
                                 e.nonaffine);
    } else {
        const double free =
            std::get<ImposedStress>(e.control).value * s.box.volume() - loads.first_moment;
        e.solve =
            b.solver.solve({b.matrix, &b.unit_load, 1 / loads.affine},
                           combined(b.fixed_load, free / loads.affine, b.unit_load), e.nonaffine);
        e.shear_rate = (free + dot(b.unit_load, e.nonaffine)) / loads.affine;
    }
    history.remember(s.time, e.nonaffine);
    b.last_rate = e.shear_rate;
    if (!e.model.background_drag) remove_drift(s, e.nonaffine);
}

Evaluation prepare(const State& state, const Model& model, const Control& control,
                   Workspace::Buffers& b)
{
    update_neighbours(state, model, b);
    Evaluation e;
    if (!b.spare.empty()) {
        e = std::move(b.spare.back());
        b.spare.pop_back();
    }
    e.model = model;
    e.control = control;
    e.solve = {};
    const Stiffness k = stiffness(model, control);
    find_pairs(state, interaction_range(model), b.neighbours, b.pairs);
    e.pairs.clear();
    for (const Pair& pair : b.pairs) e.pairs.push_back(pair_state(pair, state, model, k));
    find_contact_loads(state, k, e);
    assemble_matrix(state, e, b);
    return e;
}

void complete(const State& state, Evaluation& e)
{
    bool finite = std::isfinite(e.shear_rate);
    for (const Vec6& v : e.nonaffine) finite = finite && v.allFinite();
    if (!finite) throw Error(ErrorKind::numerics, "", "the shear rate or a velocity is not finite");
    e.motion.clear();
    e.motion.reserve(e.contacts.size());
    for (const ContactLoad& c : e.contacts)
        e.motion.push_back(relative_motion(state, e, e.pairs[c.pair].pair));
}

Evaluation evaluate(const State& state, const Model& model, const Control& control,
                    Workspace& workspace)
{
    Workspace::Buffers& b = workspace.buffers();
    Evaluation e = prepare(state, model, control, b);
    const Loads loads = assemble_loads(state, e, b);
    if (uses_dashpot(model) && std::holds_alternative<ImposedStress>(control))
        solve_twice(state, loads, b, e);
    else
        solve_at_once(state, loads, b.history[0], b, e);
    complete(state, e);
    return e;
}

const std::vector<Pair>& touching_pairs(const State& state, const Model& model,
                                        Workspace& workspace)
{
    Workspace::Buffers& b = workspace.buffers();
    update_neighbours(state, model, b);
    find_pairs(state, 0, b.neighbours, b.pairs);
    return b.pairs;
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
