// engine/resistance_matrix.h -- R_FU as the particles see it: diagonal blocks and compressed pairs.
//
// All entries of a pair block are functions of the normal and a few scalars, so a pair needs 8
// numbers and not 36. A contact spring treated implicitly has the same structure. Symmetric by
// construction; positive definite if every drag is positive.
#pragma once
#include "engine/types.h"

#include <array>
#include <vector>

namespace sigmaflow {

/// Off-diagonal block of pair (i, j): rows of i, columns of j. Signs as in pair_resistance.h.
struct PairBlock {
    int i, j;
    int candidate;  // position in the sparsity pattern
    Vec3 normal;
    double xa, ya, yb11, yb21, yc12;
};

/// Diagonal block of a particle: symmetric parts of translation and rotation, and their coupling,
/// which is the cross product with one vector, because it is a sum of such products.
///   force = translation U + coupling x Omega,  torque = -coupling x U + rotation Omega
struct DiagonalBlock {
    // xx, yy, zz, xy, xz, yz
    std::array<double, 6> translation{}, rotation{};
    std::array<double, 3> coupling{};
};

/// Adds normal nn + shear P (translation), turn P (rotation), twist n (coupling), P = 1 - nn.
inline void add_pair(DiagonalBlock& b, const Vec3& n, double normal, double shear, double twist,
                     double turn)
{
    const double x = n.x(), y = n.y(), z = n.z(), difference = normal - shear;
    const double products[6] = {x * x, y * y, z * z, x * y, x * z, y * z};
    for (int k = 0; k < 6; ++k) {
        b.translation[k] += difference * products[k];
        b.rotation[k] -= turn * products[k];
    }
    for (int k = 0; k < 3; ++k) {
        b.translation[k] += shear;
        b.rotation[k] += turn;
    }
    b.coupling[0] += twist * x;
    b.coupling[1] += twist * y;
    b.coupling[2] += twist * z;
}

Mat6 full(const DiagonalBlock& block);

struct ResistanceMatrix {
    std::vector<DiagonalBlock> diagonal;  // [n]
    std::vector<PairBlock> pairs;         // sorted by (i, j)

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
