// engine/resistance_matrix.h -- R_FU as the particles see it: diagonal blocks and compressed pairs.
//
// All entries of a pair block are functions of the normal and a few scalars, so a pair needs 8
// numbers and not 36. A contact spring treated implicitly has the same structure. Symmetric by
// construction; positive definite if every drag is positive.
#pragma once
#include "engine/types.h"

#include <vector>

namespace sigmaflow {

/// Off-diagonal block of pair (i, j): rows of i, columns of j. Signs as in pair_resistance.h.
struct PairBlock {
    int i, j;
    int candidate;  // position in the sparsity pattern
    Vec3 normal;
    double xa, ya, yb11, yb21, yc12;
};

struct ResistanceMatrix {
    std::vector<Mat6> diagonal;    // [n]
    std::vector<PairBlock> pairs;  // sorted by (i, j)

    int size() const { return static_cast<int>(diagonal.size()); }
};

/// Rows (F, T) of i, columns (U, Omega) of j.
Mat6 off_diagonal(const PairBlock& pair);

/// Block times the velocities of j: load on i.
inline Vec6 times(const PairBlock& p, const Vec6& v)
{
    const Vec3 u = v.head<3>(), w = v.tail<3>();
    Vec6 load;
    load.head<3>() =
        (p.ya - p.xa) * p.normal.dot(u) * p.normal - p.ya * u + p.yb21 * p.normal.cross(w);
    load.tail<3>() = p.yb11 * p.normal.cross(u) + p.yc12 * (w - p.normal.dot(w) * p.normal);
    return load;
}

/// Transposed block times the velocities of i: load on j.
inline Vec6 transposed_times(const PairBlock& p, const Vec6& v)
{
    const Vec3 u = v.head<3>(), w = v.tail<3>();
    Vec6 load;
    load.head<3>() =
        (p.ya - p.xa) * p.normal.dot(u) * p.normal - p.ya * u - p.yb11 * p.normal.cross(w);
    load.tail<3>() = -p.yb21 * p.normal.cross(u) + p.yc12 * (w - p.normal.dot(w) * p.normal);
    return load;
}

/// Velocity, then angular velocity (or force, then torque) of every particle [n].
using Velocities = std::vector<Vec6>;

/// result = R . v
void multiply(const ResistanceMatrix& matrix, const Velocities& v, Velocities& result);

double dot(const Velocities& u, const Velocities& v);

}
