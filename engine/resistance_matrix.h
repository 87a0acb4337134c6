// engine/resistance_matrix.h -- R_FU as the particles see it: the drag of each and compressed
// pairs.
//
// All entries of a pair block are functions of the normal and a few scalars, so a pair needs 10
// numbers and not 78. A contact spring treated implicitly has the same structure. Symmetric by
// construction; positive definite if every drag is positive. Particles and pairs are in the order
// of the slices (engine/slices.h).
#pragma once
#include "engine/slices.h"
#include "engine/team.h"
#include "engine/types.h"

#include <vector>

namespace sigmaflow {

/// Eight pairs; normal from the first to the second particle, scalars as in pair_resistance.h.
struct alignas(64) PairGroup {
    d8 nx, ny, nz, xa, ya, yb11, yb21, yc11, yc12, yc22;
};

/// Diagonal blocks of eight particles: symmetric parts of translation and rotation
/// (xx, yy, zz, xy, xz, yz), and their coupling, which is the cross product with one vector,
/// because it is a sum of such products.
///   force = translation U + coupling x Omega,  torque = -coupling x U + rotation Omega
template <class V>
struct alignas(64) DiagonalSlice {
    V translation[6], rotation[6], coupling[3];
};

struct ResistanceMatrix {
    const Slices* slices = nullptr;
    std::vector<D8> drag;          // [2 count]: translation, then rotation of every slice
    std::vector<PairGroup> pairs;  // [groups + 1], the last one zero

    int size() const { return slices->particles; }
};

/// r = b - R v for the slices of a range, given the rows of v (8 doubles a slot, six of them used).
void subtract_product(const ResistanceMatrix& matrix, const SlicedVector& v, const double* rows,
                      const SlicedVector& b, Range range, SlicedVector& r);

/// Rows of eight doubles, (x y z 0, x y z 0), of the slices of a range.
void write_rows(const SlicedVector& v, Range range, double* rows);

/// result = R . v, on one thread.
void multiply(const ResistanceMatrix& matrix, const SlicedVector& v, SlicedVector& result);

/// Diagonal blocks of the slices of a range.
void diagonal_blocks(const ResistanceMatrix& matrix, Range range, DiagonalSlice<d8>* blocks);

/// Full blocks, for direct solvers and tests: of a slot, and of rows of the first, columns of the
/// second particle of a pair.
Mat6 diagonal_block(const DiagonalSlice<d8>* blocks, int slot);
Mat6 off_diagonal_block(const ResistanceMatrix& matrix, int pair);

}
