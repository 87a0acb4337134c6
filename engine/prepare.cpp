// prepare: forces and resistance matrix of a state; what the force balance needs of them.
#include "engine/ambient.h"
#include "engine/checks.h"
#include "engine/forces/repulsion.h"
#include "engine/lean_resize.h"
#include "engine/workspace.h"

#include <algorithm>

namespace sigmaflow {

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
        const bool known = at < s.contacts.size() && s.contacts[at].i == i && s.contacts[at].j == j;
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
    check_model(model, control);
    locate(s, model, b);
    if (!stage) check_overlaps(b.touching_pairs);  // those of a prediction need not come true
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
            if (stage) write_rows(b.right, own, b.row_values());
        });
        team.barrier();
        const Range contacts = team.share(0, static_cast<int>(b.touching.size()));
        for (int c = contacts.begin; c < contacts.end; ++c) {
            const Pair& pair = b.touching_pairs[c];
            e.contacts[c] = contact_load(
                pair, s.radius[pair.i], s.radius[pair.j],
                b.memory[c] < 0 ? Contact{pair.i, pair.j} : s.contacts[b.memory[c]], model, k);
            add_contact(s, e.contacts[c], b.touching[c], b);
            if (stage)
                add_springs(s, k, e.contacts[c], b.touching[c], stage->ahead, (*stage->share)[c],
                            b);
        }
        team.barrier();
        team.own(b.slices, [&](Range own) {
            if (stage)
                add_predicted_motion(b.slices, b.row_values(), stage->predicted_rate, own, b.table,
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
                dashpot_unit_load(
                    s, pair_state(e.contacts[c].pair, static_cast<int>(c), s, e.model, k)));
        to_slices(loads, b.slices, b.right);
        for (int k2 = 0; k2 < b.slices.count; ++k2)
            for (int c = 0; c < 6; ++c) b.unit_load[k2].c[c] += b.right[k2].c[c];
    }
    return result;
}

}
