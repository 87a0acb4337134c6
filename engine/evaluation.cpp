#include "engine/evaluation.h"

#include "engine/ambient.h"
#include "engine/error.h"
#include "engine/forces/repulsion.h"
#include "engine/solver.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow {

using lubrication::PairLoad;
using lubrication::PairStresslet;

struct Workspace::Buffers {
    NeighbourList neighbours;
    SpdSolver solver;
    ResistanceMatrix matrix;
    std::array<Velocities, column_names.size()> loads;
};

Workspace::Workspace() : buffers_(std::make_unique<Buffers>()) {}
Workspace::~Workspace() = default;
Workspace::Workspace(Workspace&&) noexcept = default;
Workspace& Workspace::operator=(Workspace&&) noexcept = default;

namespace {

bool uses_dashpot(const Model& m)
{
    return m.contact_hydrodynamics == ContactHydrodynamics::dashpot;
}

double interaction_range(const Model& m)
{
    return std::max(m.lubrication_range, m.repulsion_range);
}

void update_neighbours(const State& state, const Model& m, Workspace::Buffers& b)
{
    if (b.neighbours.update(state, interaction_range(m)))
        b.solver.set_pattern(state.size(), b.neighbours.candidates());
}

PairState pair_state(const Pair& pair, const State& s, const Model& m, const Stiffness& k)
{
    const double a = s.radius[pair.i], b = s.radius[pair.j];
    PairState p{pair, {}, repulsion(pair, a, b, m), pair.touching() && uses_dashpot(m)};
    if (pair.xi < m.lubrication_range) {
        auto [L, l] = lubrication::gap_factors(pair.xi, m.lubrication_delta);
        if (pair.touching() && m.contact_relaxation_time > 0)
            L = 4 * k.normal * m.contact_relaxation_time;
        p.resistance = lubrication::scaled(lubrication::pair_coefficients(a, b), L, l);
    }
    return p;
}

// Forces of all touching pairs; a pair without memory starts with relaxed springs, sticking.
std::vector<ContactLoad> contact_loads(const std::vector<PairState>& pairs, const State& s,
                                       const Model& m, const Stiffness& k)
{
    std::vector<ContactLoad> loads;
    auto memory = s.contacts.begin();
    for (std::size_t index = 0; index < pairs.size(); ++index) {
        const Pair& pair = pairs[index].pair;
        if (!pair.touching()) continue;
        while (memory != s.contacts.end() &&
               (memory->i < pair.i || (memory->i == pair.i && memory->j < pair.j)))
            ++memory;
        const bool known = memory != s.contacts.end() && memory->i == pair.i && memory->j == pair.j;
        loads.push_back(contact_load(pair, s.radius[pair.i], s.radius[pair.j],
                                     known ? *memory : Contact{pair.i, pair.j}, m, k));
        loads.back().pair = static_cast<int>(index);
    }
    return loads;
}

void add(Velocities& loads, const Pair& pair, const PairLoad& load)
{
    loads[pair.i].head<3>() += load.force_i;
    loads[pair.i].tail<3>() += load.torque_i;
    loads[pair.j].head<3>() += load.force_j;
    loads[pair.j].tail<3>() += load.torque_j;
}

PairLoad dashpot_unit_load(const State& s, const PairState& p)
{
    const auto [vi, vj] = with_image({ambient(s, p.pair.i), ambient(s, p.pair.j)}, p.pair, s, 1);
    return negative(lubrication::resistance_times(p.resistance, p.pair.normal, vi, vj));
}

void assemble_loads(const State& s, const Evaluation& e,
                    std::array<Velocities, column_names.size()>& loads)
{
    for (Velocities& column : loads) column.assign(s.size(), Vec6::Zero());
    for (const PairState& p : e.pairs) {
        if (p.dashpot)
            add(loads[column_dashpot], p.pair, dashpot_unit_load(s, p));
        else
            add(loads[column_hydro], p.pair,
                lubrication::strain_load(p.resistance, p.pair.normal, unit_strain_rate()));
        const Vec3 repulsive = -p.repulsion * p.pair.normal;
        loads[column_repulsion][p.pair.i].head<3>() += repulsive;
        loads[column_repulsion][p.pair.j].head<3>() -= repulsive;
    }
    for (const ContactLoad& c : e.contacts)
        add(loads[column_contact], e.pairs[c.pair].pair,
            {c.force_on_i, c.torque_on_i, -c.force_on_i, c.torque_on_j});
}

void add_diagonal(const lubrication::PairResistance& r, const Vec3& n, Mat6& on_i, Mat6& on_j)
{
    const Mat3 nn = n * n.transpose();
    const Mat3 tangential = Mat3::Identity() - nn;
    const Mat3 translation = r.xa * nn + r.ya * tangential, twist = cross_matrix(n);
    on_i.topLeftCorner<3, 3>() += translation;
    on_i.topRightCorner<3, 3>() += r.yb11 * twist;
    on_i.bottomLeftCorner<3, 3>() -= r.yb11 * twist;
    on_i.bottomRightCorner<3, 3>() += r.yc11 * tangential;
    on_j.topLeftCorner<3, 3>() += translation;
    on_j.topRightCorner<3, 3>() -= r.yb21 * twist;
    on_j.bottomLeftCorner<3, 3>() += r.yb21 * twist;
    on_j.bottomRightCorner<3, 3>() += r.yc22 * tangential;
}

void assemble_matrix(const State& s, const Evaluation& e, ResistanceMatrix& matrix)
{
    matrix.diagonal.resize(s.size());
    for (int i = 0; i < s.size(); ++i) matrix.diagonal[i] = drag(s, e.model, i).asDiagonal();
    matrix.pairs.clear();
    for (const PairState& p : e.pairs) {
        const auto& r = p.resistance;
        if (r.xa == 0) continue;  // repulsion alone
        add_diagonal(r, p.pair.normal, matrix.diagonal[p.pair.i], matrix.diagonal[p.pair.j]);
        matrix.pairs.push_back({p.pair.i, p.pair.j, p.pair.candidate, p.pair.normal, r.xa, r.ya,
                                r.yb11, r.yb21, r.yc12});
    }
}

// In the limit of vanishing drag the forces balance only if sum a_i V_i = 0.
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

void solve_columns(const State& s, Workspace::Buffers& b, Evaluation& e)
{
    std::vector<const Velocities*> right;
    std::vector<Velocities*> solutions;
    for (std::size_t c = 0; c < column_names.size(); ++c) {
        if (c == column_dashpot && !uses_dashpot(e.model)) {
            e.column[c].assign(s.size(), Vec6::Zero());
            continue;
        }
        right.push_back(&b.loads[c]);
        solutions.push_back(&e.column[c]);
    }
    b.solver.factorise(b.matrix);
    b.solver.solve(right, solutions);
    if (!e.model.background_drag)
        for (Velocities* v : solutions) remove_drift(s, *v);
}

Mat3 sum_of(const PairStresslet& stresslet)
{
    return stresslet.on_i + stresslet.on_j;
}

// Visits the stress of every pair: visit(part, pair, per unit rate, independent of the rate), each
// with the shares of both particles.
template <class Visit>
void visit_pair_stress(const State& s, const Evaluation& e, const Visit& visit)
{
    const PairStresslet none{Mat3::Zero(), Mat3::Zero()};
    auto virial = [&](const Pair& pair, const Vec3& force) {
        const double share = s.radius[pair.i] / (s.radius[pair.i] + s.radius[pair.j]);
        const Mat3 moment = sym(pair.separation, force);
        return PairStresslet{share * moment, (1 - share) * moment};
    };
    for (const PairState& p : e.pairs) {
        const Pair& pair = p.pair;
        if (p.repulsion != 0)
            visit(repulsion_xF, pair, none, virial(pair, -p.repulsion * pair.normal));
        auto gather = [&](Column c) {
            return PairVelocities{e.column[c][pair.i], e.column[c][pair.j]};
        };
        if (p.dashpot) {
            auto force = [&](const PairVelocities& v) -> Vec3 {
                return -lubrication::resistance_times(p.resistance, pair.normal, v.i, v.j).force_i;
            };
            const PairVelocities hydro = gather(column_hydro), dash = gather(column_dashpot),
                                 contact = gather(column_contact), rep = gather(column_repulsion);
            const PairVelocities unit = with_image(
                {hydro.i + dash.i + ambient(s, pair.i), hydro.j + dash.j + ambient(s, pair.j)},
                pair, s, 1);
            visit(dashpot_xF, pair, virial(pair, force(unit)),
                  virial(pair, force({contact.i + rep.i, contact.j + rep.j})));
            continue;
        }
        if (p.resistance.xa == 0) continue;
        auto stresslet = [&](Column c) {
            return lubrication::velocity_stresslet(p.resistance, pair.normal, e.column[c][pair.i],
                                                   e.column[c][pair.j]);
        };
        visit(hydro_RSE, pair,
              lubrication::strain_stresslet(p.resistance, pair.normal, unit_strain_rate()), none);
        visit(hydro_RSU, pair, stresslet(column_hydro), none);
        if (uses_dashpot(e.model)) visit(dashpot_RSU, pair, stresslet(column_dashpot), none);
        visit(contact_RSU, pair, none, stresslet(column_contact));
        visit(repulsion_RSU, pair, none, stresslet(column_repulsion));
    }
    for (const ContactLoad& c : e.contacts)
        visit(contact_xF, e.pairs[c.pair].pair, none, virial(e.pairs[c.pair].pair, c.force_on_i));
}

// eqs. 2 and 3 of the paper
void find_rate_and_stress(const State& s, Evaluation& e)
{
    StressParts unit, fixed;
    unit.fill(Mat3::Zero());
    fixed.fill(Mat3::Zero());
    visit_pair_stress(s, e,
                      [&](StressPart part, const Pair&, const PairStresslet& per_rate,
                          const PairStresslet& free) {
                          unit[part] += sum_of(per_rate);
                          fixed[part] += sum_of(free);
                      });
    const double volume = s.box.volume();
    const double viscosity = e.model.einstein ? 1 + 2.5 * volume_fraction(s) : 1;
    unit[solvent] = 2 * viscosity * volume * unit_strain_rate();
    double unit_shear = 0, fixed_shear = 0;
    for (std::size_t p = 0; p < unit.size(); ++p) {
        unit_shear += unit[p](flow, gradient) / volume;
        fixed_shear += fixed[p](flow, gradient) / volume;
    }
    if (const auto* rate = std::get_if<ImposedRate>(&e.control))
        e.shear_rate = rate->value;
    else
        e.shear_rate = (std::get<ImposedStress>(e.control).value - fixed_shear) / unit_shear;
    if (!std::isfinite(e.shear_rate))
        throw Error(ErrorKind::numerics, "", "the shear rate is not finite");
    for (std::size_t p = 0; p < unit.size(); ++p)
        e.stress[p] = (e.shear_rate * unit[p] + fixed[p]) / volume;
}

void superpose(const State& s, Evaluation& e)
{
    e.nonaffine.resize(s.size());
    bool finite = true;
    for (int i = 0; i < s.size(); ++i) {
        e.nonaffine[i] = e.shear_rate * (e.column[column_hydro][i] + e.column[column_dashpot][i]) +
                         e.column[column_contact][i] + e.column[column_repulsion][i];
        finite = finite && e.nonaffine[i].allFinite();
    }
    if (!finite) throw Error(ErrorKind::numerics, "", "a velocity is not finite");
}

}

ContactMotion relative_motion(const State& s, const Evaluation& e, const Pair& pair)
{
    const auto [vi, vj] = moving(s, e, pair);
    const double a = s.radius[pair.i], b = s.radius[pair.j], harmonic = 2 * a * b / (a + b);
    const Vec3& n = pair.normal;
    const Vec3 relative =
        vj.head<3>() - vi.head<3>() - (a * vi.tail<3>() + b * vj.tail<3>()).cross(n);
    return {relative - relative.dot(n) * n, harmonic * (vj.tail<3>() - vi.tail<3>()).cross(n)};
}

std::vector<Pair> touching_pairs(const State& state, const Model& model, Workspace& workspace)
{
    Workspace::Buffers& b = workspace.buffers();
    update_neighbours(state, model, b);
    return find_pairs(state, 0, b.neighbours);
}

Mat3 Evaluation::total_stress() const
{
    Mat3 sum = Mat3::Zero();
    for (const Mat3& part : stress) sum += part;
    return sum;
}

Evaluation evaluate(const State& state, const Model& model, const Control& control,
                    Workspace& workspace)
{
    Workspace::Buffers& b = workspace.buffers();
    update_neighbours(state, model, b);
    Evaluation e;
    e.model = model;
    e.control = control;
    const Stiffness k = stiffness(model, control);
    for (const Pair& pair : find_pairs(state, interaction_range(model), b.neighbours))
        e.pairs.push_back(pair_state(pair, state, model, k));
    e.contacts = contact_loads(e.pairs, state, model, k);
    assemble_loads(state, e, b.loads);
    assemble_matrix(state, e, b.matrix);
    solve_columns(state, b, e);
    find_rate_and_stress(state, e);
    superpose(state, e);
    for (const ContactLoad& c : e.contacts)
        e.motion.push_back(relative_motion(state, e, e.pairs[c.pair].pair));
    return e;
}

std::vector<Mat3> particle_stress(const State& state, const Evaluation& e)
{
    std::vector<Mat3> result(state.size(), Mat3::Zero());
    if (e.model.einstein)
        for (int i = 0; i < state.size(); ++i)
            result[i] =
                20 * pi / 3 * std::pow(state.radius[i], 3) * e.shear_rate * unit_strain_rate();
    visit_pair_stress(state, e,
                      [&](StressPart, const Pair& pair, const PairStresslet& per_rate,
                          const PairStresslet& free) {
                          result[pair.i] += e.shear_rate * per_rate.on_i + free.on_i;
                          result[pair.j] += e.shear_rate * per_rate.on_j + free.on_j;
                      });
    return result;
}

}
