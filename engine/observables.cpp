// What is derived from an evaluation for output: forces of pairs, samples and frames.
#include "engine/ambient.h"
#include "engine/evaluation.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow {

namespace {

double nonaffine_speed(const Evaluation& e, int i)
{
    return e.nonaffine[i].head<3>().norm() / std::abs(e.shear_rate);
}

}

std::vector<PairForces> pair_forces(const State& state, const Evaluation& e)
{
    std::vector<PairForces> forces;
    forces.reserve(e.pairs.size());
    const Mat3 E = e.shear_rate * unit_strain_rate();
    for (const PairState& p : e.pairs) {
        PairForces f{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), -p.repulsion * p.pair.normal};
        if (p.contact >= 0) f.contact = e.contacts[p.contact].force_on_i;
        const Vec6 &vi = e.nonaffine[p.pair.i], &vj = e.nonaffine[p.pair.j];
        if (p.dashpot)
            f.dashpot = dashpot_load(state, e, p).force_i;
        else
            f.lubrication =
                lubrication::strain_load(resistance(state, p), p.pair.normal, E).force_i -
                lubrication::resistance_times(resistance(state, p), p.pair.normal, vi, vj).force_i;
        forces.push_back(f);
    }
    return forces;
}

std::span<const SampleField> sample_fields()
{
    static constexpr SampleField fields[] = {
        {"strain", "-", "accumulated strain", &Sample::strain},
        {"time", "1/rate0", "time", &Sample::time},
        {"shear_rate", "rate0", "shear rate", &Sample::shear_rate},
        {"shear_stress", "sigma0", "shear stress", &Sample::shear_stress},
        {"viscosity", "eta0", "shear stress over shear rate", &Sample::viscosity},
        {"normal_stress_difference_1", "sigma0", "N1 = S_xx - S_yy",
         &Sample::normal_stress_difference_1},
        {"normal_stress_difference_2", "sigma0", "N2 = S_yy - S_zz",
         &Sample::normal_stress_difference_2},
        {"particle_pressure", "sigma0", "-tr(S)/3", &Sample::particle_pressure},
        {"stress_solvent", "sigma0", "shear stress of the solvent, with 5/2 phi if on",
         &Sample::stress_solvent},
        {"stress_hydrodynamic", "sigma0", "shear stress of lubrication and dashpots",
         &Sample::stress_hydrodynamic},
        {"stress_contact", "sigma0", "shear stress of contacts", &Sample::stress_contact},
        {"stress_repulsion", "sigma0", "shear stress of the repulsion", &Sample::stress_repulsion},
        {"contact_number", "-", "touching neighbours per particle, 2 N_c/n",
         &Sample::contact_number},
        {"frictional_contact_number", "-", "frictional touching neighbours per particle",
         &Sample::frictional_contact_number},
        {"sliding_fraction", "-", "sliding share of the frictional contacts",
         &Sample::sliding_fraction},
        {"smallest_xi", "-",
         "smallest reduced gap, at most the range of the forces; minus it is the largest overlap",
         &Sample::smallest_xi},
        {"mean_nonaffine_speed", "-", "mean of |U - U_inf|/(|rate| a)",
         &Sample::mean_nonaffine_speed},
    };
    return fields;
}

namespace {

Sample sample_of(const State& state, const Evaluation& e, const StressSummary& stress)
{
    const Mat3& S = stress.total;
    Sample s;
    s.strain = state.strain;
    s.time = state.time;
    s.shear_rate = e.shear_rate;
    s.shear_stress = S(flow, gradient);
    s.viscosity = s.shear_stress / e.shear_rate;
    s.normal_stress_difference_1 = S(0, 0) - S(1, 1);
    s.normal_stress_difference_2 = S(1, 1) - S(2, 2);
    s.particle_pressure = -S.trace() / 3;
    s.stress_solvent = stress.solvent;
    s.stress_hydrodynamic = stress.hydrodynamic;
    s.stress_contact = stress.contact;
    s.stress_repulsion = stress.repulsion;
    int frictional = 0, sliding = 0;
    for (const ContactLoad& c : e.contacts) {
        frictional += c.frictional;
        sliding += c.frictional && c.memory.sliding;
    }
    const double n = std::max(state.size(), 1);
    s.contact_number = 2 * static_cast<double>(e.contacts.size()) / n;
    s.frictional_contact_number = 2 * frictional / n;
    s.sliding_fraction = frictional ? static_cast<double>(sliding) / frictional : 0;
    // spheres that are all farther apart: infinity could not be stored
    s.smallest_xi = std::max(e.model.lubrication_range, e.model.repulsion_range);
    for (const PairState& p : e.pairs) s.smallest_xi = std::min(s.smallest_xi, p.pair.xi);
    double speed = 0;
    for (int i = 0; i < state.size(); ++i) speed += nonaffine_speed(e, i);
    s.mean_nonaffine_speed = speed / n;
    return s;
}

}

Sample make_sample(const State& state, const SampledEvaluation& s)
{
    return sample_of(state, s.evaluation, s.stress);
}

Sample make_sample(const State& state, const DetailedEvaluation& d)
{
    return sample_of(state, d.evaluation, summary_of(d));
}

Frame make_frame(const State& state, const DetailedEvaluation& d)
{
    const Evaluation& e = d.evaluation;
    Frame f;
    f.state = state;
    f.sample = make_sample(state, d);
    f.volume_fraction = volume_fraction(state);
    f.species = species(state);
    f.particle_stress = particle_stress(state, d);
    f.contact_number.assign(state.size(), 0);
    const Velocities total = total_velocities(state, e);
    for (int i = 0; i < state.size(); ++i) {
        f.velocity.push_back(total[i].head<3>());
        f.angular_velocity.push_back(total[i].tail<3>());
        f.nonaffine_velocity.push_back(e.nonaffine[i].head<3>());
        f.nonaffine_speed.push_back(nonaffine_speed(e, i));
    }
    f.state.contacts.clear();
    for (const ContactLoad& c : e.contacts) {
        const Pair& pair = c.pair;
        ++f.contact_number[pair.i];
        ++f.contact_number[pair.j];
        f.state.contacts.push_back(c.memory);
        f.contacts.push_back({pair.i, pair.j, state.position[pair.i],
                              state.position[pair.i] + pair.separation, pair.xi,
                              c.load / reference_force, c.friction / reference_force,
                              c.memory.sliding, c.frictional});
    }
    return f;
}

}
