// engine/ambient.h -- the ambient shear flow and velocities of pairs across the sheared boundary.
//
//   U_inf(x) = rate y e_x,  w_inf = -(rate/2) e_z,  E_inf = rate Ehat,  Ehat_xy = Ehat_yx = 1/2
#pragma once
#include "engine/evaluation.h"

namespace sigmaflow {

/// Ehat: strain rate per unit shear rate.
inline Mat3 unit_strain_rate()
{
    Mat3 E = Mat3::Zero();
    E(flow, gradient) = E(gradient, flow) = 0.5;
    return E;
}

/// Ambient velocity and angular velocity per unit shear rate at particle i.
inline Vec6 ambient(const State& s, int i)
{
    Vec6 v;
    v << s.position[i].y(), 0, 0, 0, 0, -0.5;
    return v;
}

/// Stokes drag coefficients of particle i: 6 pi a (force), 8 pi a^3 (torque), times the drag
/// factor. Without background drag a factor of 1e-8 stands for the limit 0: the velocities differ
/// from the limit by that order once the drift is removed.
inline Vec6 drag(const State& s, const Model& m, int i)
{
    const double zeta = m.background_drag ? m.drag_factor : 1e-8;
    const double a = s.radius[i];
    Vec6 d;
    d.head<3>().setConstant(zeta * 6 * pi * a);
    d.tail<3>().setConstant(zeta * 8 * pi * a * a * a);
    return d;
}

struct PairVelocities {
    Vec6 i, j;
};

/// Velocities of i and of the image of j when they contain an ambient flow of the given rate.
inline PairVelocities with_image(PairVelocities v, const Pair& pair, const State& s, double rate)
{
    v.j(flow) += rate * pair.image * s.box.length.y();
    return v;
}

/// Total velocities of i and of the image of j at non-affine velocities v and a shear rate.
inline PairVelocities moving(const State& s, const Velocities& v, double rate, const Pair& pair)
{
    return with_image(
        {v[pair.i] + rate * ambient(s, pair.i), v[pair.j] + rate * ambient(s, pair.j)}, pair, s,
        rate);
}

inline PairVelocities moving(const State& s, const Evaluation& e, const Pair& pair)
{
    return moving(s, e.nonaffine, e.shear_rate, pair);
}

/// Relative motion of the surfaces of a pair.
inline ContactMotion relative_motion(const State& s, const PairVelocities& v, const Pair& pair)
{
    const double a = s.radius[pair.i], b = s.radius[pair.j], harmonic = 2 * a * b / (a + b);
    const Vec3 &n = pair.normal, turn_i = v.i.tail<3>(), turn_j = v.j.tail<3>();
    const Vec3 relative = v.j.head<3>() - v.i.head<3>() - (a * turn_i + b * turn_j).cross(n);
    return {relative - relative.dot(n) * n, harmonic * (turn_j - turn_i).cross(n)};
}

inline lubrication::PairLoad negative(const lubrication::PairLoad& load)
{
    return {-load.force_i, -load.torque_i, -load.force_j, -load.torque_j};
}

/// Load of a touching pair in the dashpot variant.
inline lubrication::PairLoad dashpot_load(const State& s, const Evaluation& e, const PairState& p)
{
    const auto [vi, vj] = moving(s, e, p.pair);
    return negative(lubrication::resistance_times(resistance(s, p), p.pair.normal, vi, vj));
}

}
