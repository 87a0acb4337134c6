// engine/forces/contact.h -- springs and friction of touching pairs.
//
// Linear springs with Coulomb friction (Mari, Seto, Morris, Denn, J. Rheol. 58, 1693, 2014;
// tangential spring as in Luding, Granular Matter 10, 235, 2008), optional rolling resistance and
// critical load. On i: F_n = -N n with N = kn abar (s - r), F_t = kt abar t; torques a n x F_t and
// b n x F_t. |F_t| <= mu N_f with N_f = max(N - F_CL, 0). Deviation: the law rescales only when
// |F_t| > (1 - 1e-10) limit, which makes it idempotent: loading a stored state changes neither
// forces nor flags.
#pragma once
#include "engine/model.h"
#include "engine/pairs.h"
#include "engine/state.h"

namespace sigmaflow {

/// Forces of one contact; friction, rolling moment and load in eta0 rate0 a^2.
struct ContactLoad {
    Pair pair;
    Contact memory;   // springs after projection and friction law
    double load = 0;  // N
    bool frictional = false;
    Vec3 friction = Vec3::Zero();  // F_t on i
    Vec3 force_on_i = Vec3::Zero();
    Vec3 torque_on_i = Vec3::Zero(), torque_on_j = Vec3::Zero();
};

template <class Archive>
void archive(Archive& a, ContactLoad& c)
{
    a(c.pair, c.memory, c.load, c.frictional, c.friction, c.force_on_i, c.torque_on_i,
      c.torque_on_j);
}

/// Law of one touching pair with the given memory; a, b: radii of i and j.
ContactLoad contact_load(const Pair& pair, double a, double b, const Contact& memory,
                         const Model& model, const Stiffness& stiffness);

/// A tangential vector carried from the plane of n0 to that of n1 by the smallest rotation.
inline Vec3 carried(const Vec3& v, const Vec3& n0, const Vec3& n1)
{
    return v - v.dot(n1) / (1 + n0.dot(n1)) * (n0 + n1);
}

}
