// engine/lubrication/pair_resistance.h -- resistance of one pair of spheres: scalars, blocks,
// loads.
//
// Pair 1 = i (radius a), 2 = j (radius b), normal n from i to j; a 12-vector is (U1, Omega1, U2,
// Omega2) or (F1, T1, F2, T2). Hydrodynamic load = - block . V + R_FE:E. Signs and symmetries let
// every function be written with the entries kept here: XA12 = -XA11, YB12 = -YB11, XG12 = -XG11,
// ... Sources: Jeffrey & Onishi, J. Fluid Mech. 139, 261 (1984); Jeffrey, Phys. Fluids A 4, 16
// (1992). Deviation: traces of the stresslets are kept (Jeffrey 1992 subtracts a third of them):
// the singular part is then the first moment of the traction in the gap, whose trace is the
// particle pressure (Jeffrey, Morris & Brady, Phys. Fluids A 5, 2317, 1993). Shear stress, N1 and
// N2 do not see it. Tested: published values, R_SU = R_FE^T, symmetric positive semidefinite block,
// rigid motion.
#pragma once
#include "engine/types.h"

namespace sigmaflow::lubrication {

/// Resistance scalars in eta0 a^k; first index: particle of the load, second: of the velocity.
struct PairResistance {
    double xa = 0;              // XA11 = XA22 = -XA12
    double ya = 0;              // YA11
    double yb11 = 0, yb21 = 0;  // YB12 = -YB11, YB22 = -YB21
    double yc11 = 0, yc12 = 0, yc22 = 0;
    double xg11 = 0, xg21 = 0;  // XG12 = -XG11, XG22 = -XG21
    double yg11 = 0, yg21 = 0;
    double yh11 = 0, yh12 = 0, yh21 = 0, yh22 = 0;
    double xm11 = 0, xm12 = 0, xm22 = 0;
    double ym11 = 0, ym12 = 0, ym22 = 0;
};

/// Scalars at L = l = 1 of spheres of radii a and b [a] > 0; they include the factor 6 pi.
PairResistance pair_coefficients(double a, double b);

/// Scalars at the factors L of the X and l of the Y functions.
PairResistance scaled(const PairResistance& coefficients, double L, double l);

/// L = 1/(xi + delta) at max(xi, 0) and l = ln(max(L, 1)).
struct GapFactors {
    double L, l;
};
GapFactors gap_factors(double xi, double delta);

/// Load of a pair: on i (force, torque), on j (force, torque).
struct PairLoad {
    Vec3 force_i, torque_i, force_j, torque_j;
};

/// R_FU . V of the pair (the hydrodynamic load is minus this).
inline PairLoad resistance_times(const PairResistance& r, const Vec3& n, const Vec6& vi,
                                 const Vec6& vj)
{
    const Vec3 du = vi.head<3>() - vj.head<3>();
    const Vec3 wi = vi.tail<3>(), wj = vj.tail<3>();
    const Vec3 normal = n.dot(du) * n, twist = n.cross(du);
    const Vec3 force = r.xa * normal + r.ya * (du - normal) + n.cross(r.yb11 * wi + r.yb21 * wj);
    const Vec3 ti = r.yc11 * wi + r.yc12 * wj, tj = r.yc12 * wi + r.yc22 * wj;
    return {force, -r.yb11 * twist + ti - n.dot(ti) * n, -force,
            -r.yb21 * twist + tj - n.dot(tj) * n};
}

/// R_FE : E of the pair.
PairLoad strain_load(const PairResistance& r, const Vec3& n, const Mat3& E);

/// Stresslets of both particles.
struct PairStresslet {
    Mat3 on_i, on_j;
};

/// - R_SU . V
PairStresslet velocity_stresslet(const PairResistance& r, const Vec3& n, const Vec6& vi,
                                 const Vec6& vj);

/// R_SE : E
PairStresslet strain_stresslet(const PairResistance& r, const Vec3& n, const Mat3& E);

}
