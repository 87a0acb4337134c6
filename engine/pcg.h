// engine/pcg.h -- conjugate gradients for (K - w f f^T) x = b, K = L + A_D + L^T in 6x6 blocks.
//
// Preconditioner M = (D + L) D^-1 (D + L)^T with the blocks D of the diagonal-based incomplete
// factor,
//   D_i = A_i - sum_{j<i} L_ij D_j^-1 L_ij^T   (Meijerink & van der Vorst, Math. Comp. 31, 148,
//   1977),
// applied in the form of Eisenstat (SIAM J. Sci. Stat. Comput. 2, 1, 1981): one backward and one
// forward sweep per iteration, no separate product with K. Pairs stay compressed (one cache line).
// D may belong to an earlier matrix: any positive definite D gives a valid preconditioner. A block
// that is not positive definite is replaced by A_i.
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
    /// Everything a sweep needs of a pair; block of rows j, columns i is L_ji.
    struct alignas(64) SweepPair {
        double n[3], ya_minus_xa, ya, yb_i, yb_j, yc;
    };
    struct Sweep;

    void load(const ResistanceMatrix& matrix);
    void refresh_factor(const ResistanceMatrix& matrix);

    int n_ = 0;
    int age_ = -1;                     // solves since the factor was made; -1: there is none
    std::vector<SweepPair> pairs_;     // grouped by i
    std::vector<int> first_, column_;  // CSR over i of the particles j > i
    const DiagonalBlock* diagonal_ = nullptr;  // A_i [n], of the matrix being solved
    std::vector<double> inverse_;              // D_i^-1 [n * 36], symmetric
    std::vector<double> work_;
};

}
