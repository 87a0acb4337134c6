// engine/units.h -- the one unit system.
//
// Lengths in a (radius of the small spheres), viscosities in eta0 (the solvent), rates in rate0 =
// F*/(6 pi eta0 a^2). Hence stresses are in sigma0 = eta0 rate0 and the force scale of the
// repulsion is F* = 6 pi eta0 a^2 rate0 = 6 pi (Mari, Seto, Morris, Denn, Phys. Rev. E 91, 052302,
// 2015, end of section II). Every rate, stress, viscosity, strain and time is the number of the
// paper. Users give forces in F* and stiffnesses in F*/a; they are multiplied by reference_force
// where used.
#pragma once
#include <numbers>

namespace sigmaflow {

inline constexpr double pi = std::numbers::pi;
inline constexpr double reference_force =
    6 * pi;  // F* [eta0 rate0 a^2]; also the drag of a unit sphere

}
