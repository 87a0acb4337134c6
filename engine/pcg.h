// engine/pcg.h -- conjugate gradients for (K - w f f^T) x = b, K = L + A_D + L^T in 6x6 blocks.
//
// Preconditioner M = (D + L) D^-1 (D + L)^T with the blocks D of the diagonal-based incomplete
// factor,
//   D_i = A_i - sum_{j<i} L_ij D_j^-1 L_ij^T   (Meijerink & van der Vorst, Math. Comp. 31, 148,
//   1977),
// applied in the form of Eisenstat (SIAM J. Sci. Stat. Comput. 2, 1, 1981): one backward and one
// forward sweep per iteration, no separate product with K. Pairs stay compressed, four to a group,
// so that a sweep works on four at once whatever vectors the processor has. D may belong to an
// earlier matrix: any positive definite D gives a valid preconditioner. A block that is not
// positive definite is replaced by A_i.
//
// Convergence: sqrt(r.M^-1 r) <= tolerance sqrt(b.M^-1 b).
#pragma once
#include "engine/resistance_matrix.h"
#include "engine/solver.h"

#include <cstddef>
#include <vector>

namespace sigmaflow {

class ConjugateGradients {
public:
    /// Forgets the incomplete factor: the next solve makes a new one.
    void forget() { age_ = -1; }

    /// x: the guess on entry. Sets report.iterations; false if the tolerance was not reached.
    bool solve(const ResistanceProblem& problem, const Velocities& b, Velocities& x,
               double tolerance, SolveReport& report);

private:
    /// Four pairs of one particle i, lane by lane; L_ji: rows of j, columns of i. Lanes that are
    /// not used are zero and point to a particle that does not exist.
    struct alignas(64) PairGroup {
        double nx[4], ny[4], nz[4], ya_minus_xa[4], ya[4], yb_i[4], yb_j[4], yc[4];
        int j[4];
    };
    /// (x, y, z, 0) of the translation, then of the rotation.
    struct alignas(64) Lanes {
        double v[8];
    };
    /// Six columns of a symmetric block.
    struct alignas(64) Block {
        Lanes column[6];
    };
    struct Sweep;

    void load(const ResistanceMatrix& matrix);
    void refresh_factor(const ResistanceMatrix& matrix);

    int n_ = 0;
    int age_ = -1;                   // solves since the factor was made; -1: there is none
    std::vector<PairGroup> groups_;  // grouped by i
    std::vector<int> first_;         // [n + 1]: first group of each particle
    std::vector<int> first_pair_;    // [n + 1]: first pair of each particle in the matrix
    const DiagonalBlock* diagonal_ = nullptr;  // A_i [n], of the matrix being solved
    std::vector<Block> inverse_;               // D_i^-1 [n]
    std::vector<Mat6> factor_;                 // D_i while the factor is made
    std::vector<Lanes> work_;                  // vectors of n + 1 particles, the last one zero
};

}
