// engine/pair_table.h -- geometry, resistance and forces of all pairs, eight at a time.
//
// The same formulas as pairs.h, lubrication/pair_resistance.h and forces/ have for one pair, in the
// order of the slices. Pairs beyond a range keep their place with coefficients of zero until the
// neighbour list is made anew. Tested against the formulas for one pair.
#pragma once
#include "engine/model.h"
#include "engine/resistance_matrix.h"
#include "engine/slices.h"
#include "engine/state.h"

#include <vector>

namespace sigmaflow {

/// What the radii say: those of the first and the second particle, their sum (1 in unused lanes),
/// and the resistance scalars at L = l = 1.
struct alignas(64) PairShape {
    d8 a, b, sum, xa, ya, yb11, yb21, yc11, yc12, yc22;
};

/// From the first to the nearest image of the second particle; `image`: the row of images.
struct alignas(64) PairGeometry {
    d8 nx, ny, nz, distance, xi, image;
};

/// L and l of the resistance (zero beyond its range) and size of the repulsion.
struct alignas(64) PairFactors {
    d8 L, l, repulsion;
};

/// Force on the first particle, n x friction (times the radius it is the torque on either), and the
/// rolling moment on the first.
struct alignas(64) PairForce {
    Triple<d8> force, lever, roll;
};

/// Resistance of springs over the time that an implicit stage looks ahead: along the normal, to
/// slip, and to rolling (times both radii).
struct alignas(64) PairSprings {
    d8 normal, shear, roll;
};

struct PairTable {
    std::vector<PairShape> shape;
    std::vector<PairGeometry> geometry;
    std::vector<PairFactors> factors;
    std::vector<PairForce> force;
    std::vector<PairSprings> springs;  // used in implicit stages only
};

/// Makes room and fills the shapes.
void make_shapes(const State& state, const Slices& slices, int threads, PairTable& table);

/// Rows (x, y, z, 0) of the positions, one a slot [slots + 1].
void write_positions(const State& state, const Slices& slices, Range range, double* rows);

/// Geometry of the pairs of the slices of a range; false if centres coincide or are not finite.
bool find_geometry(const Slices& slices, const Box& box, const double* rows, Range range,
                   PairTable& table);

/// Factors, and the repulsion as the only force. Partial sums of the shear moment of the repulsion,
/// sum of r (n.e) (n.F), for each slice.
void find_factors(const Slices& slices, const Model& model, const Stiffness& stiffness, Range range,
                  PairTable& table, D8* moment);

/// Springs of the repulsion alone.
void find_repulsion_springs(const Slices& slices, const Model& model, double ahead, Range range,
                            PairTable& table);

/// Adds what the springs resist to the predicted motion (rows of V, shear rate), and its part of
/// the shear moment.
void add_predicted_motion(const Slices& slices, const double* rows, double shear_rate, Range range,
                          PairTable& table, D8* moment);

/// Pairs of the matrix: lubrication, and springs if asked.
void fill_matrix(const Slices& slices, const PairTable& table, bool with_springs, Range range,
                 ResistanceMatrix& matrix);

/// Loads of the slices of a range: per unit shear rate in the affine flow, and of the forces.
/// Partial sums of Ehat:R_SE:Ehat. `touching_drive`: whether touching pairs feel the affine flow.
struct LoadSums {
    SlicedVector &unit, &fixed;
    D8* affine;
};
void sum_loads(const Slices& slices, const PairTable& table, const ResistanceMatrix& matrix,
               bool touching_drive, Range range, const LoadSums& sums);

}
