// engine/lubrication/resistance_functions.h -- leading singular terms of the two-sphere
// resistances.
//
// lambda  size ratio a_j / a_i [-] > 0
// The X functions are to be multiplied by L = 1/(xi + delta), the Y functions by l = ln L (0 if L
// <= 1), xi = 2 gap/(a_i + a_j). Sources: A, B, C: Jeffrey & Onishi, J. Fluid Mech. 139, 261
// (1984); G, H, M: Jeffrey, Phys. Fluids A 4, 16 (1992); regularisation: Ball & Melrose, Physica A
// 247, 444 (1997). Tested: table of closed-form values, exchange of the spheres, rigid motion of a
// touching pair.
#pragma once

namespace sigmaflow::lubrication {

// clang-format off
constexpr double g1_xa(double x) { return 2 * x * x / ((1 + x) * (1 + x) * (1 + x)); }
constexpr double g2_ya(double x) { return 4. / 15 * x * (2 + x + 2 * x * x) / ((1 + x) * (1 + x) * (1 + x)); }
constexpr double g2_yb(double x) { return -1. / 5 * x * (4 + x) / ((1 + x) * (1 + x)); }
constexpr double g2_yc(double x) { return 2. / 5 * x / (1 + x); }
constexpr double g4_yc(double x) { return 4. / 5 * x * x / ((1 + x) * (1 + x) * (1 + x) * (1 + x)); }
constexpr double g1_xg(double x) { return 3 * x * x / ((1 + x) * (1 + x) * (1 + x)); }
constexpr double g2_yg(double x) { return 1. / 10 * x * (4 - x + 7 * x * x) / ((1 + x) * (1 + x) * (1 + x)); }
constexpr double g2_yh(double x) { return 1. / 10 * x * (2 - x) / ((1 + x) * (1 + x)); }
constexpr double g5_yh(double x) { return 1. / 20 * x * x * (1 + 7 * x) / ((1 + x) * (1 + x)); }
constexpr double g1_xm(double x) { return 6. / 5 * x * x / ((1 + x) * (1 + x) * (1 + x)); }
constexpr double g4_xm(double x) { return 6. / 5 * x * x * x / ((1 + x) * (1 + x) * (1 + x)); }
constexpr double g2_ym(double x) { return 6. / 25 * x * (1 - x + 4 * x * x) / ((1 + x) * (1 + x) * (1 + x)); }
constexpr double g5_ym(double x) { return 3. / 50 * x * x * (7 - 10 * x + 7 * x * x) / ((1 + x) * (1 + x) * (1 + x)); }
// clang-format on

}
