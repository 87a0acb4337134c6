// evaluate_in_detail: a solution for every force, and every component of the stress.
#include "engine/ambient.h"
#include "engine/checks.h"
#include "engine/error.h"
#include "engine/evaluation.h"
#include "engine/workspace.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow {

using lubrication::PairLoad;
using lubrication::PairStresslet;

namespace {

using Columns = std::array<Velocities, column_names.size()>;

Columns assemble_columns(const State& s, const Evaluation& e)
{
    Columns loads;
    for (Velocities& column : loads) column.assign(s.size(), Vec6::Zero());
    for (const PairState& p : e.pairs) {
        if (p.dashpot)
            add(loads[column_dashpot], p.pair, dashpot_unit_load(s, p));
        else
            add(loads[column_hydro], p.pair,
                lubrication::strain_load(resistance(s, p), p.pair.normal, unit_strain_rate()));
        const Vec3 repulsive = -p.repulsion * p.pair.normal;
        add(loads[column_repulsion], p.pair, {repulsive, Vec3::Zero(), -repulsive, Vec3::Zero()});
    }
    for (const ContactLoad& c : e.contacts)
        add(loads[column_contact], c.pair,
            {c.force_on_i, c.torque_on_i, -c.force_on_i, c.torque_on_j});
    return loads;
}

void solve_columns(const State& s, const Columns& loads, Workspace::Buffers& b,
                   DetailedEvaluation& d)
{
    check_forces(d.evaluation.contacts);
    std::vector<const Velocities*> right;
    std::vector<Velocities*> solutions;
    for (std::size_t c = 0; c < column_names.size(); ++c) {
        if (c == column_dashpot && !uses_dashpot(d.evaluation.model)) {
            d.column[c].assign(s.size(), Vec6::Zero());
            continue;
        }
        right.push_back(&loads[c]);
        solutions.push_back(&d.column[c]);
    }
    d.evaluation.solve = b.solver.solve_directly(b.matrix, right, solutions);
    if (!d.evaluation.model.background_drag)
        for (Velocities* v : solutions) remove_drift(s, *v);
}

void check_stress(const Mat3& stress, std::string_view name)
{
    if (stress.allFinite()) return;
    int row = 0, column = 0;
    while (std::isfinite(stress(row, column))) column == 2 ? (++row, column = 0) : ++column;
    throw Error(
        ErrorKind::numerics, "",
        "the stress " + std::string(name) + "_" + "xyz"[row] + "xyz"[column] + " is not finite");
}

Mat3 sum_of(const PairStresslet& stresslet)
{
    return stresslet.on_i + stresslet.on_j;
}

const PairStresslet no_stresslet{Mat3::Zero(), Mat3::Zero()};

// First moment of a pair force on i, shared by the particles as their radii.
PairStresslet virial(const State& s, const Pair& pair, const Vec3& force)
{
    const double share = s.radius[pair.i] / (s.radius[pair.i] + s.radius[pair.j]);
    const Mat3 moment = sym(pair.separation, force);
    return {share * moment, (1 - share) * moment};
}

// Both parts of dashpot_xF of a pair: per unit rate, free of the rate.
std::pair<PairStresslet, PairStresslet> dashpot_virials(const State& s, const DetailedEvaluation& d,
                                                        const PairState& p)
{
    const Pair& pair = p.pair;
    const auto r = resistance(s, p);
    const auto sum_at = [&](Column first, Column second, int k) -> Vec6 {
        return d.column[first][k] + d.column[second][k];
    };
    const auto force = [&](const PairVelocities& v) -> Vec3 {
        return -lubrication::resistance_times(r, pair.normal, v.i, v.j).force_i;
    };
    const PairVelocities unit =
        with_image({sum_at(column_hydro, column_dashpot, pair.i) + ambient(s, pair.i),
                    sum_at(column_hydro, column_dashpot, pair.j) + ambient(s, pair.j)},
                   pair, s, 1);
    const PairVelocities fixed{sum_at(column_contact, column_repulsion, pair.i),
                               sum_at(column_contact, column_repulsion, pair.j)};
    return {virial(s, pair, force(unit)), virial(s, pair, force(fixed))};
}

// Visits the stress of every pair: visit(part, pair, per unit rate, free of the rate), each with
// the shares of both particles.
template <class Visit>
void visit_pair_stress(const State& s, const DetailedEvaluation& d, const Visit& visit)
{
    const Evaluation& e = d.evaluation;
    for (const PairState& p : e.pairs) {
        const Pair& pair = p.pair;
        if (p.repulsion != 0)
            visit(repulsion_xF, pair, no_stresslet, virial(s, pair, -p.repulsion * pair.normal));
        if (p.factors.L == 0) continue;
        if (p.dashpot) {
            const auto [unit, fixed] = dashpot_virials(s, d, p);
            visit(dashpot_xF, pair, unit, fixed);
            continue;
        }
        const auto r = resistance(s, p);
        const auto stresslet = [&](Column c) {
            return lubrication::velocity_stresslet(r, pair.normal, d.column[c][pair.i],
                                                   d.column[c][pair.j]);
        };
        visit(hydro_RSE, pair, lubrication::strain_stresslet(r, pair.normal, unit_strain_rate()),
              no_stresslet);
        visit(hydro_RSU, pair, stresslet(column_hydro), no_stresslet);
        if (uses_dashpot(e.model))
            visit(dashpot_RSU, pair, stresslet(column_dashpot), no_stresslet);
        visit(contact_RSU, pair, no_stresslet, stresslet(column_contact));
        visit(repulsion_RSU, pair, no_stresslet, stresslet(column_repulsion));
    }
    for (const ContactLoad& c : e.contacts)
        visit(contact_xF, c.pair, no_stresslet, virial(s, c.pair, c.force_on_i));
}

// eqs. 2 and 3 of the paper
void find_rate_and_stress(const State& s, DetailedEvaluation& d)
{
    StressParts unit, fixed;
    unit.fill(Mat3::Zero());
    fixed.fill(Mat3::Zero());
    visit_pair_stress(s, d,
                      [&](StressPart part, const Pair&, const PairStresslet& per_rate,
                          const PairStresslet& free) {
                          unit[part] += sum_of(per_rate);
                          fixed[part] += sum_of(free);
                      });
    const double volume = s.box.volume();
    unit[solvent] = 2 * solvent_resistance(s, d.evaluation.model) * unit_strain_rate();
    double unit_shear = 0, fixed_shear = 0;
    for (std::size_t p = 0; p < unit.size(); ++p) {
        unit_shear += unit[p](flow, gradient) / volume;
        fixed_shear += fixed[p](flow, gradient) / volume;
    }
    double& rate = d.evaluation.shear_rate;
    if (const auto* imposed = std::get_if<ImposedRate>(&d.evaluation.control))
        rate = imposed->value;
    else
        rate = (std::get<ImposedStress>(d.evaluation.control).value - fixed_shear) / unit_shear;
    check_scalar(rate, "the shear rate");
    for (std::size_t p = 0; p < unit.size(); ++p) {
        d.stress[p] = (rate * unit[p] + fixed[p]) / volume;
        check_stress(d.stress[p], stress_part_names[p]);
    }
}

void superpose(const State& s, DetailedEvaluation& d)
{
    Evaluation& e = d.evaluation;
    e.nonaffine.resize(s.size());
    for (int i = 0; i < s.size(); ++i)
        e.nonaffine[i] = e.shear_rate * (d.column[column_hydro][i] + d.column[column_dashpot][i]) +
                         d.column[column_contact][i] + d.column[column_repulsion][i];
}

}

Mat3 DetailedEvaluation::total_stress() const
{
    Mat3 sum = Mat3::Zero();
    for (const Mat3& part : stress) sum += part;
    return sum;
}

DetailedEvaluation evaluate_in_detail(const State& state, const Model& model,
                                      const Control& control, Workspace& workspace)
{
    Workspace::Buffers& b = workspace.buffers();
    check_state(state);
    DetailedEvaluation d;
    d.evaluation = prepare(state, model, control, nullptr, b);
    list_pairs(state, d.evaluation, workspace);
    solve_columns(state, assemble_columns(state, d.evaluation), b, d);
    find_rate_and_stress(state, d);
    superpose(state, d);
    complete(state, b.threads, d.evaluation);
    b.history.remember(state.time, d.evaluation.nonaffine, d.evaluation.shear_rate);
    return d;
}

namespace {

constexpr double sample_tolerance = 1e-8;

// Work of a pair's load at velocities.
double work(const PairLoad& load, const Pair& pair, const Velocities& v)
{
    return load.force_i.dot(v[pair.i].head<3>()) + load.torque_i.dot(v[pair.i].tail<3>()) +
           load.force_j.dot(v[pair.j].head<3>()) + load.torque_j.dot(v[pair.j].tail<3>());
}

// Total stress from the velocities, and its shear components by origin from those of the flow
// alone.
StressSummary summarise(const State& s, const Evaluation& e, const Velocities& hydrodynamic)
{
    StressSummary sum;
    const Mat3 E = e.shear_rate * unit_strain_rate();
    Mat3 lubrication = Mat3::Zero();
    const auto add_force = [&](const Pair& pair, const PairLoad& load, double& part) {
        const Mat3 moment = sym(pair.separation, load.force_i);
        sum.total += moment;
        part += moment(flow, gradient) - work(load, pair, hydrodynamic);
    };
    for (const PairState& p : e.pairs) {
        if (p.repulsion != 0) {
            const Vec3 force = -p.repulsion * p.pair.normal;
            add_force(p.pair, {force, Vec3::Zero(), -force, Vec3::Zero()}, sum.repulsion);
        }
        if (p.factors.L == 0) continue;
        const auto r = resistance(s, p);
        const PairStresslet flow_part = lubrication::strain_stresslet(r, p.pair.normal, E);
        lubrication += sum_of(flow_part) +
                       sum_of(lubrication::velocity_stresslet(
                           r, p.pair.normal, e.nonaffine[p.pair.i], e.nonaffine[p.pair.j]));
        sum.hydrodynamic +=
            sum_of(flow_part)(flow, gradient) -
            work(lubrication::strain_load(r, p.pair.normal, E), p.pair, hydrodynamic);
    }
    for (const ContactLoad& c : e.contacts)
        add_force(c.pair, {c.force_on_i, c.torque_on_i, -c.force_on_i, c.torque_on_j}, sum.contact);
    const double volume = s.box.volume();
    sum.solvent = solvent_resistance(s, e.model) * e.shear_rate / volume;
    sum.total = (sum.total + lubrication) / volume + 2 * sum.solvent * unit_strain_rate();
    sum.hydrodynamic /= volume;
    sum.contact /= volume;
    sum.repulsion /= volume;
    check_scalar(sum.solvent, "the stress of the solvent");
    check_stress(sum.total, "total");
    check_scalar(sum.hydrodynamic, "the hydrodynamic stress");
    check_scalar(sum.contact, "the stress of the contacts");
    check_scalar(sum.repulsion, "the stress of the repulsion");
    return sum;
}

}

StressSummary summary_of(const DetailedEvaluation& d)
{
    const auto shear = [&](StressPart p) { return d.stress[p](flow, gradient); };
    return {d.total_stress(), shear(solvent),
            shear(hydro_RSE) + shear(hydro_RSU) + shear(dashpot_RSU) + shear(dashpot_xF),
            shear(contact_xF) + shear(contact_RSU), shear(repulsion_xF) + shear(repulsion_RSU)};
}

SampledEvaluation evaluate_sample(const State& state, const Model& model, const Control& control,
                                  Workspace& workspace)
{
    if (uses_dashpot(model)) {
        DetailedEvaluation d = evaluate_in_detail(state, model, control, workspace);
        const StressSummary stress = summary_of(d);
        return {std::move(d.evaluation), stress};
    }
    check_state(state);
    Workspace::Buffers& b = workspace.buffers();
    const double share = std::min(1., sample_tolerance / b.tolerance);
    SampledEvaluation result{prepare(state, model, control, nullptr, b), {}};
    Evaluation& e = result.evaluation;
    solve_at_once(state, assemble_loads(state, e, b), b.history, b, e, share);
    if (b.hydrodynamic.size() == state.position.size())
        to_slices(b.hydrodynamic, b.slices, b.other_solution);
    else
        b.other_solution.clear();
    const SolveReport flow_alone = b.solver.solve({b.matrix}, b.unit_load, b.other_solution, share);
    e.solve.iterations += flow_alone.iterations;
    e.solve.residual = std::max(e.solve.residual, flow_alone.residual);
    e.solve.fell_back = e.solve.fell_back || flow_alone.fell_back;
    from_slices(b.other_solution, b.slices, b.hydrodynamic);
    if (!model.background_drag) remove_drift(state, b.hydrodynamic);
    complete(state, b.threads, e);
    list_pairs(state, e, workspace);
    result.stress = summarise(state, e, b.hydrodynamic);
    return result;
}

std::vector<Mat3> particle_stress(const State& state, const DetailedEvaluation& d)
{
    const Evaluation& e = d.evaluation;
    std::vector<Mat3> result(state.size(), Mat3::Zero());
    if (e.model.einstein)
        for (int i = 0; i < state.size(); ++i)
            result[i] =
                20 * pi / 3 * std::pow(state.radius[i], 3) * e.shear_rate * unit_strain_rate();
    visit_pair_stress(state, d,
                      [&](StressPart, const Pair& pair, const PairStresslet& per_rate,
                          const PairStresslet& free) {
                          result[pair.i] += e.shear_rate * per_rate.on_i + free.on_i;
                          result[pair.j] += e.shear_rate * per_rate.on_j + free.on_j;
                      });
    return result;
}

}
