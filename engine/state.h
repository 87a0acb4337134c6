// engine/state.h -- what is needed to continue a run, and nothing that can be recomputed.
#pragma once
#include "engine/box.h"
#include "engine/types.h"

#include <vector>

namespace sigmaflow {

/// Memory of one touching pair i < j.
struct Contact {
    int i = 0, j = 0;
    Vec3 spring = Vec3::Zero();   // tangential stretch [a], perpendicular to the normal
    Vec3 rolling = Vec3::Zero();  // rolling stretch [a]
    bool sliding = false;
};

template <class Archive>
void archive(Archive& a, Contact& c)
{
    a(c.i, c.j, c.spring, c.rolling, c.sliding);
}

struct State {
    Box box;
    std::vector<Vec3> position;     // [n] [a]
    std::vector<double> radius;     // [n] [a] > 0
    std::vector<Contact> contacts;  // sorted by (i, j)
    double strain = 0;              // accumulated [-]
    double time = 0;                // [1/rate0]
    double time_step = 0;           // proposed for the next implicit step [1/rate0]; 0: none yet

    int size() const { return static_cast<int>(radius.size()); }
};

template <class Archive>
void archive(Archive& a, State& s)
{
    a(s.box, s.position, s.radius, s.contacts, s.strain, s.time, s.time_step);
}

/// For states that come from a file: at least one particle, radii and box positive, everything
/// finite, no position farther than 1e9 boxes, contacts sorted pairs of particles. Errors: input.
void check_stored_state(const State& state);

/// The state seen in a mirror that turns x around. Shearing it at the stress sigma is shearing the
/// original at -sigma: the flow reversed.
State mirrored(State state);

/// Sum of the particle volumes over the box volume [-].
double volume_fraction(const State& state);

/// Index of each particle's radius in the ascending list of distinct radii: 0 for the smallest.
std::vector<int> species(const State& state);

}
