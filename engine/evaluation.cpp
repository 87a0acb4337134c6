#include "engine/evaluation.h"

#include "engine/ambient.h"
#include "engine/error.h"
#include "engine/forces/repulsion.h"
#include "engine/lean_resize.h"
#include "engine/workspace.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow {

using lubrication::PairLoad;

Workspace::Workspace(const SolverSettings& solver) : buffers_(std::make_unique<Buffers>(solver)) {}
Workspace::~Workspace() = default;
Workspace::Workspace(Workspace&&) noexcept = default;
Workspace& Workspace::operator=(Workspace&&) noexcept = default;

double SolutionHistory::guess(double at, Velocities& v, int threads) const
{
    v.clear();
    if (known == 0) return 0;
    v = solution[0];
    const double interval = time[0] - time[1], ahead = at - time[0];
    // beyond a few intervals a straight line is worse than the last value
    if (known == 1 || ahead == 0 || !(std::abs(ahead) < 4 * std::abs(interval))) return rate[0];
    const double weight = ahead / interval;
    for_each(threads, v.size(), [&](int i) { v[i] += weight * (solution[0][i] - solution[1][i]); });
    return rate[0] + weight * (rate[0] - rate[1]);
}

void SolutionHistory::remember(double at, const Velocities& v, double shear_rate)
{
    if (known > 0 && solution[0].size() != v.size()) known = 0;
    if (known > 0 && at != time[0]) {
        std::swap(solution[0], solution[1]);
        time[1] = time[0];
        rate[1] = rate[0];
        known = 2;
    }
    known = std::max(known, 1);
    time[0] = at;
    rate[0] = shear_rate;
    solution[0] = v;
}

void recycle(Evaluation&& evaluation, Workspace& workspace)
{
    // a step needs two; copies that callers made must not pile up
    auto& spare = workspace.buffers().spare;
    if (spare.size() < 2) spare.push_back(std::move(evaluation));
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

void make_pattern(const State& s, Workspace::Buffers& b)
{
    const auto& candidates = b.neighbours.candidates();
    b.solver.set_pattern(s.size(), candidates);
    b.slice_maker.make(s, candidates, b.slices);
    make_shapes(s, b.slices, b.threads, b.table);
    const std::size_t count = b.slices.count + 1;
    b.matrix.slices = &b.slices;
    lean_resize(b.matrix.pairs, b.slices.groups() + 1);
    b.matrix.pairs.back() = PairGroup{};
    b.matrix.drag.resize(2 * count);
    b.rows.resize(count * lanes);
    b.moment.resize(count);
    b.affine.resize(count);
    b.unit_load.resize(count);
    b.unit_load.back() = Slice6{};
    b.fixed_load.resize(count);
    b.fixed_load.back() = Slice6{};
    b.right.resize(count);
    b.right.back() = Slice6{};
}

double* row_values(Workspace::Buffers& b)
{
    return b.rows.data()->v;
}

}

namespace {

void find_touching(const State& s, Workspace::Buffers& b)
{
    b.touching_parts.resize(std::max(b.threads, 1));
    const auto& candidates = b.neighbours.candidates();
    with_team(b.threads, [&](const Team& team) {
        std::vector<int>& found = b.touching_parts[team.rank];
        found.clear();
        const Range own = team.share(0, static_cast<int>(candidates.size()));
        for (int k = own.begin; k < own.end; ++k) {
            const int pair = b.slices.pair_of[k];
            if (b.table.geometry[pair / lanes].xi[pair % lanes] <= 0) found.push_back(k);
        }
    });
    b.touching.clear();
    for (const auto& part : b.touching_parts)
        b.touching.insert(b.touching.end(), part.begin(), part.end());
    lean_resize(b.touching_pairs, b.touching.size());
    for_each(b.threads, b.touching.size(), [&](int k) {
        const int candidate = b.touching[k];
        const int pair = b.slices.pair_of[candidate], l = pair % lanes;
        const PairGeometry& g = b.table.geometry[pair / lanes];
        const double sign = b.slices.flipped[candidate] ? -1 : 1;
        const auto [i, j] = candidates[candidate];
        const Vec3 normal = sign * Vec3(g.nx[l], g.ny[l], g.nz[l]);
        b.touching_pairs[k] = {i,      j,
                               static_cast<int>(sign * g.image[l]),
                               g.distance[l] * normal,
                               normal, g.distance[l],
                               g.distance[l] - s.radius[i] - s.radius[j],
                               g.xi[l]};
    });
}

}

void locate(const State& s, const Model& m, Workspace::Buffers& b)
{
    const double range = interaction_range(m);
    if (b.located && b.range == range && b.box.offset == s.box.offset &&
        b.box.length == s.box.length && b.position == s.position && b.radius == s.radius)
        return;
    b.located = false;
    if (b.neighbours.update(s, range, b.threads)) make_pattern(s, b);
    bool good = true;
    with_team(b.threads, [&](const Team& team) {
        team.own(b.slices,
                 [&](Range own) { write_positions(s, b.slices, own, row_values(b)); });
        if (team.rank == 0)  // the particle of unused lanes, where no other is
            std::fill_n(row_values(b) + 4 * b.slices.slots(), 3, -s.box.length.x() / 3);
        team.barrier();
        team.own(b.slices, [&](Range own) {
            if (!find_geometry(b.slices, s.box, row_values(b), own, b.table)) {
#pragma omp atomic write
                good = false;
            }
        });
    });
    if (!good) find_pairs(s, range, b.neighbours);  // throws and says which centres coincide
    find_touching(s, b);
    b.position = s.position;
    b.radius = s.radius;
    b.box = s.box;
    b.range = range;
    b.located = true;
}

namespace {

PairState pair_state(const Pair& pair, int contact, const State& s, const Model& m,
                     const Stiffness& k)
{
    PairState p{pair,
                {0, 0},
                repulsion(pair, s.radius[pair.i], s.radius[pair.j], m),
                contact,
                contact >= 0 && uses_dashpot(m)};
    if (pair.xi < m.lubrication_range) {
        p.factors = lubrication::gap_factors(pair.xi, m.lubrication_delta);
        if (contact >= 0 && m.contact_relaxation_time > 0)
            p.factors.L = 4 * k.normal * m.contact_relaxation_time;
    }
    return p;
}

// The contact of the state that each touching pair remembers; both are sorted by (i, j).
void find_memories(const State& s, Workspace::Buffers& b)
{
    b.memory.clear();
    std::size_t at = 0;
    for (int k : b.touching) {
        const auto [i, j] = b.neighbours.candidates()[k];
        while (at < s.contacts.size() &&
               (s.contacts[at].i < i || (s.contacts[at].i == i && s.contacts[at].j < j)))
            ++at;
        const bool known =
            at < s.contacts.size() && s.contacts[at].i == i && s.contacts[at].j == j;
        b.memory.push_back(known ? static_cast<int>(at) : -1);
    }
}

double shear_moment(const Vec3& d, const Vec3& force)
{
    return 0.5 * (d.x() * force.y() + d.y() * force.x());
}

/// Adds to one vector of one pair in the table.
void add_to(Triple<d8>& sum, int lane, const Vec3& v)
{
    sum.x[lane] += v.x();
    sum.y[lane] += v.y();
    sum.z[lane] += v.z();
}

// A contact in the table: the first particle of the pair may be j.
void add_contact(const State& s, const ContactLoad& c, int candidate, Workspace::Buffers& b)
{
    const int pair = b.slices.pair_of[candidate], lane = pair % lanes;
    PairForce& f = b.table.force[pair / lanes];
    const double sign = b.slices.flipped[candidate] ? -1 : 1;
    const Vec3 lever = c.pair.normal.cross(c.friction);
    add_to(f.force, lane, sign * c.force_on_i);
    add_to(f.lever, lane, lever);
    add_to(f.roll, lane, sign * (c.torque_on_i - s.radius[c.pair.i] * lever));
}

void fill_drag(const State& s, const Model& m, Workspace::Buffers& b)
{
    for (int slot = 0; slot < b.slices.slots(); ++slot) {
        const int i = b.slices.particle[slot];
        const Vec6 own = i < 0 ? Vec6(Vec6::Ones()) : drag(s, m, i);
        b.matrix.drag[2 * (slot / lanes)].v[slot % lanes] = own[0];
        b.matrix.drag[2 * (slot / lanes) + 1].v[slot % lanes] = own[3];
    }
}

// A spring of stiffness k that follows a relative motion v for the time `ahead` changes its force
// by - ahead k v: the structure of a pair resistance with XA = ahead kn, YA = ahead kt. A sliding
// contact keeps the secant of its friction, `share` of kt.
void add_springs(const State& s, const Stiffness& k, const ContactLoad& c, int candidate,
                 double ahead, double share, Workspace::Buffers& b)
{
    const double x = s.radius[c.pair.i], y = s.radius[c.pair.j];
    const double scale = reference_force * ahead * (x + y) / 2;
    const double harmonic = 2 * x * y / (x + y);
    const int pair = b.slices.pair_of[candidate], lane = pair % lanes;
    PairSprings& spring = b.table.springs[pair / lanes];
    spring.normal[lane] = scale * k.normal;
    spring.shear[lane] = scale * k.tangential * share;
    spring.roll[lane] = scale * k.rolling * harmonic * harmonic;
}

}

Evaluation prepare(const State& s, const Model& model, const Control& control,
                   const ImplicitStage* stage, Workspace::Buffers& b)
{
    locate(s, model, b);
    Evaluation e;
    if (!b.spare.empty()) {
        e = std::move(b.spare.back());
        b.spare.pop_back();
    }
    e.model = model;
    e.control = control;
    e.solve = {};
    e.pairs.clear();
    const Stiffness k = stiffness(model, control);
    find_memories(s, b);
    lean_resize(e.contacts, b.touching.size());
    if (stage) to_slices(*stage->predicted, b.slices, b.right, b.threads);
    fill_drag(s, model, b);
    with_team(b.threads, [&](const Team& team) {
        team.own(b.slices, [&](Range own) {
            find_factors(b.slices, model, k, own, b.table, b.moment.data());
            if (stage) find_repulsion_springs(b.slices, model, stage->ahead, own, b.table);
            if (stage) write_rows(b.right, own, row_values(b));
        });
        team.barrier();
        const Range contacts = team.share(0, static_cast<int>(b.touching.size()));
        for (int c = contacts.begin; c < contacts.end; ++c) {
            const Pair& pair = b.touching_pairs[c];
            e.contacts[c] =
                contact_load(pair, s.radius[pair.i], s.radius[pair.j],
                             b.memory[c] < 0 ? Contact{pair.i, pair.j} : s.contacts[b.memory[c]],
                             model, k);
            add_contact(s, e.contacts[c], b.touching[c], b);
            if (stage)
                add_springs(s, k, e.contacts[c], b.touching[c], stage->ahead, (*stage->share)[c],
                            b);
        }
        team.barrier();
        team.own(b.slices, [&](Range own) {
            if (stage)
                add_predicted_motion(b.slices, row_values(b), stage->predicted_rate, own, b.table,
                                     b.moment.data());
            fill_matrix(b.slices, b.table, stage != nullptr, own, b.matrix);
        });
        team.barrier();
        team.own(b.slices, [&](Range own) {
            sum_loads(b.slices, b.table, b.matrix, !uses_dashpot(model), own,
                      {b.unit_load, b.fixed_load, b.affine.data()});
        });
    });
    return e;
}

void list_pairs(const State& s, Evaluation& e, Workspace& workspace)
{
    const Stiffness k = stiffness(e.model, e.control);
    locate(s, e.model, workspace.buffers());
    e.pairs.clear();
    std::size_t c = 0;
    for (const Pair& pair :
         find_pairs(s, interaction_range(e.model), workspace.buffers().neighbours)) {
        const bool touches = c < e.contacts.size() && e.contacts[c].pair.i == pair.i &&
                             e.contacts[c].pair.j == pair.j;
        e.pairs.push_back(pair_state(pair, touches ? static_cast<int>(c++) : -1, s, e.model, k));
    }
}

Loads assemble_loads(const State& s, const Evaluation& e, Workspace::Buffers& b)
{
    Loads result;
    d8 affine{}, moment{};
    for (int k = 0; k < b.slices.count; ++k) {
        affine += b.affine[k].v;
        moment += b.moment[k].v;
    }
    result.affine = solvent_resistance(s, e.model) + total(affine);
    result.first_moment = total(moment);
    for (const ContactLoad& c : e.contacts)
        result.first_moment += shear_moment(c.pair.separation, c.force_on_i);
    if (uses_dashpot(e.model)) {
        const Stiffness k = stiffness(e.model, e.control);
        Velocities loads(s.size(), Vec6::Zero());
        for (std::size_t c = 0; c < e.contacts.size(); ++c)
            add(loads, e.contacts[c].pair,
                dashpot_unit_load(s, pair_state(e.contacts[c].pair, static_cast<int>(c), s,
                                                e.model, k)));
        to_slices(loads, b.slices, b.right);
        for (int k2 = 0; k2 < b.slices.count; ++k2)
            for (int c = 0; c < 6; ++c) b.unit_load[k2].c[c] += b.right[k2].c[c];
    }
    return result;
}

namespace {

// b = fixed + rate * unit
void combine(const SlicedVector& fixed, double rate, const SlicedVector& unit, SlicedVector& sum)
{
    sum.resize(fixed.size());
    for (std::size_t k = 0; k < sum.size(); ++k)
        for (int c = 0; c < 6; ++c) sum[k].c[c] = fixed[k].c[c] + rate * unit[k].c[c];
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
    history.guess(s.time, b.guess, b.threads);
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
        e.solve = b.solver.solve({b.matrix, &b.unit_load, 1 / loads.affine}, b.right, b.solution,
                                 share);
        e.shear_rate = (free + dot(b.unit_load, b.solution)) / loads.affine;
    }
    from_slices(b.solution, b.slices, e.nonaffine, b.threads);
    if (!e.model.background_drag) remove_drift(s, e.nonaffine);
    history.remember(s.time, e.nonaffine, e.shear_rate);
}

void complete(const State& state, int threads, Evaluation& e)
{
    bool finite = std::isfinite(e.shear_rate);
    for (const Vec6& v : e.nonaffine) finite = finite && v.allFinite();
    if (!finite) throw Error(ErrorKind::numerics, "", "the shear rate or a velocity is not finite");
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
