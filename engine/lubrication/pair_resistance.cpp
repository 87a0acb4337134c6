#include "engine/lubrication/pair_resistance.h"

#include "engine/lubrication/resistance_functions.h"
#include "engine/units.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow::lubrication {

PairResistance pair_coefficients(double a, double b)
{
    const double x = b / a, y = a / b;
    const double a2 = 2. / 3 * a * a, b2 = 2. / 3 * b * b;
    const double a3 = 4. / 3 * a * a * a, b3 = 4. / 3 * b * b * b;
    const double a4 = 10. / 9 * a * a * a, b4 = 10. / 9 * b * b * b;
    const double s = a + b;
    PairResistance r;
    r.xa = a * g1_xa(x);
    r.ya = a * g2_ya(x);
    r.yb11 = a2 * g2_yb(x);
    r.yb21 = b2 * g2_yb(y);
    r.yc11 = a3 * g2_yc(x);
    r.yc12 = s * s * s / 6 * g4_yc(x);
    r.yc22 = b3 * g2_yc(y);
    r.xg11 = a2 * g1_xg(x);
    r.xg21 = b2 * g1_xg(y);
    r.yg11 = a2 * g2_yg(x);
    r.yg21 = b2 * g2_yg(y);
    r.yh11 = a3 * g2_yh(x);
    r.yh12 = a3 * g5_yh(x);
    r.yh21 = b3 * g5_yh(y);
    r.yh22 = b3 * g2_yh(y);
    r.xm11 = a4 * g1_xm(x);
    r.xm12 = a4 * g4_xm(x);
    r.xm22 = b4 * g1_xm(y);
    r.ym11 = a4 * g2_ym(x);
    r.ym12 = a4 * g5_ym(x);
    r.ym22 = b4 * g2_ym(y);
    return scaled(r, reference_force, reference_force);
}

PairResistance scaled(const PairResistance& c, double L, double l)
{
    return {L * c.xa,   l * c.ya,   l * c.yb11, l * c.yb21, l * c.yc11, l * c.yc12, l * c.yc22,
            L * c.xg11, L * c.xg21, l * c.yg11, l * c.yg21, l * c.yh11, l * c.yh12, l * c.yh21,
            l * c.yh22, L * c.xm11, L * c.xm12, L * c.xm22, l * c.ym11, l * c.ym12, l * c.ym22};
}

GapFactors gap_factors(double xi, double delta)
{
    const double L = 1 / (std::max(xi, 0.) + delta);
    return {L, std::log(std::max(L, 1.))};
}

PairLoad strain_load(const PairResistance& r, const Vec3& n, const Mat3& E)
{
    const Vec3 e = E * n, twist = e.cross(n);
    const double xg = r.xg11 + r.xg21, yg = r.yg11 + r.yg21;
    const Vec3 force = (xg - 2 * yg) * n.dot(e) * n + 2 * yg * e;
    return {force, -2 * (r.yh11 + r.yh21) * twist, -force, -2 * (r.yh12 + r.yh22) * twist};
}

PairStresslet velocity_stresslet(const PairResistance& r, const Vec3& n, const Vec6& vi,
                                 const Vec6& vj)
{
    const Vec3 du = vi.head<3>() - vj.head<3>();
    const Mat3 normal = n.dot(du) * n * n.transpose();
    const Mat3 shear = sym(n, du) - normal;
    const Mat3 twist_i = sym(n, vi.tail<3>().cross(n)), twist_j = sym(n, vj.tail<3>().cross(n));
    return {-(r.xg11 * normal + 2 * r.yg11 * shear + 2 * (r.yh11 * twist_i + r.yh12 * twist_j)),
            -(r.xg21 * normal + 2 * r.yg21 * shear + 2 * (r.yh21 * twist_i + r.yh22 * twist_j))};
}

PairStresslet strain_stresslet(const PairResistance& r, const Vec3& n, const Mat3& E)
{
    const Vec3 e = E * n;
    const Mat3 normal = n.dot(e) * n * n.transpose();
    const Mat3 shear = sym(n, e) - normal;
    return {1.5 * (r.xm11 + r.xm12) * normal + 2 * (r.ym11 + r.ym12) * shear,
            1.5 * (r.xm12 + r.xm22) * normal + 2 * (r.ym12 + r.ym22) * shear};
}

}
