// engine/resistance_matrix.h -- R_FU as the particles see it: diagonal blocks and compressed pairs.
//
// All entries of a pair block are functions of the normal and a few scalars, so a pair needs 8 numbers
// and not 36. A contact spring treated implicitly has the same structure. Symmetric by construction;
// positive definite if every drag is positive.
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

/// result = R . v
void multiply(const ResistanceMatrix& matrix, const std::vector<Vec6>& v, std::vector<Vec6>& result);

}
