// engine/frame.h -- one instant of a run as it is stored, plotted and drawn.
//
// Sample: the scalars of the time series. Frame: everything per particle and per contact.
// `sample_fields` is the only list of the scalars: their names are the CSV columns, the HDF5
// datasets and the words of the plots.
#pragma once
#include "engine/state.h"
#include "engine/types.h"

#include <span>
#include <string_view>
#include <vector>

namespace sigmaflow {

struct Sample {
    double strain = 0, time = 0;
    double shear_rate = 0, shear_stress = 0, viscosity = 0;
    double normal_stress_difference_1 = 0, normal_stress_difference_2 = 0, particle_pressure = 0;
    // shear components of the stress, which add up to shear_stress
    double stress_solvent = 0, stress_hydrodynamic = 0, stress_contact = 0, stress_repulsion = 0;
    double contact_number = 0, frictional_contact_number = 0, sliding_fraction = 0;
    double smallest_xi = 0, mean_nonaffine_speed = 0;
};

struct SampleField {
    std::string_view name, unit, meaning;
    double Sample::*value;
};

/// All scalars of a sample in the order in which they are written.
std::span<const SampleField> sample_fields();

template <class Archive>
void archive(Archive& a, Sample& sample)
{
    for (const SampleField& field : sample_fields()) a(sample.*field.value);
}

/// One touching pair as it is drawn and stored.
struct ContactForce {
    int i = 0, j = 0;
    Vec3 start, end;                       // centre of i and of the nearest image of j [a]
    double xi = 0;                         // reduced gap [-], <= 0
    double normal_force = 0;               // repulsive spring force [F*], >= 0
    Vec3 tangential_force = Vec3::Zero();  // friction on i [F*]
    bool sliding = false, frictional = false;
};

template <class Archive>
void archive(Archive& a, ContactForce& c)
{
    a(c.i, c.j, c.start, c.end, c.xi, c.normal_force, c.tangential_force, c.sliding, c.frictional);
}

struct Frame {
    State state;
    Sample sample;
    double volume_fraction = 0;
    std::vector<Vec3> velocity;            // U [a rate0], [n]
    std::vector<Vec3> angular_velocity;    // Omega [rate0], [n]
    std::vector<Vec3> nonaffine_velocity;  // U - U_inf(x) [a rate0], [n]
    std::vector<double> nonaffine_speed;   // |U - U_inf|/(|shear_rate| a) [-], [n]
    std::vector<int> contact_number;       // touching neighbours, [n]
    std::vector<int> species;              // 0 for the smallest radius, [n]
    std::vector<Mat3> particle_stress;     // S_i [sigma0 a^3]: 2 eta0 E + sum S_i/V = total, [n]
    std::vector<ContactForce> contacts;    // sorted by (i, j)
};

template <class Archive>
void archive(Archive& a, Frame& f)
{
    a(f.state, f.sample, f.volume_fraction, f.velocity, f.angular_velocity, f.nonaffine_velocity,
      f.nonaffine_speed, f.contact_number, f.species, f.particle_stress, f.contacts);
}

}
