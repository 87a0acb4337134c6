// engine/pcg.h -- conjugate gradients for (K - w f f^T) x = b, K = L + A_D + L^T in 6x6 blocks.
//
// Iterative refinement: the residual is computed in double precision, and its correction in the
// precision of V (f8: single, d8: double) by conjugate gradients (Wilkinson, Rounding Errors in
// Algebraic Processes, 1963; mixed precision: Carson & Higham, SIAM J. Sci. Comput. 40, A817,
// 2018), until the residual is small enough: with f8 the result has the accuracy that is asked for,
// and most of the work half the memory. Nearly jammed states are too ill-conditioned for single
// precision.
//
// Preconditioner M = (D + L) D^-1 (D + L)^T with the blocks D of the diagonal-based incomplete
// factor,
//   D_i = A_i - sum_{j<i} L_ij D_j^-1 L_ij^T   (Meijerink & van der Vorst, Math. Comp. 31, 148,
//   1977),
// applied in the form of Eisenstat (SIAM J. Sci. Stat. Comput. 2, 1, 1981): one backward and one
// forward sweep per iteration, no separate product with K. The order is that of the slices: eight
// particles at once, colour after colour. D may belong to an earlier matrix: any positive definite
// D gives a valid preconditioner. A block that is not positive definite is replaced by A_i.
//
// Convergence: sqrt(r.M^-1 r) <= tolerance sqrt(b.M^-1 b).
#pragma once
#include "engine/resistance_matrix.h"
#include "engine/solver.h"

#include <vector>

namespace sigmaflow {

template <class V>
class ConjugateGradients {
public:
    /// Forgets the incomplete factor: the next solve makes a new one.
    void forget() { age_ = -1; }
    /// The incomplete factor, which may belong to an earlier matrix, and its age. Errors: input.
    template <class Archive>
    void archive(Archive& a)
    {
        std::vector<Inverse> none;
        a(age_, fresh_iterations_);
        a(age_ < 0 ? none : inverse_);
        if (age_ < -1 || fresh_iterations_ < 0 || age_ > most_solves ||
            fresh_iterations_ > most_solves)
            throw Error(ErrorKind::input, "", "has a factor of unknown age");
    }

    /// x: the guess on entry. Sets iterations and residual of the report; false if the tolerance
    /// was not reached.
    bool solve(const ResistanceProblem& problem, const SlicedVector& b, SlicedVector& x,
               double tolerance, int threads, SolveReport& report);

private:
    /// Eight pairs as one particle sees them; the normal points to the other one.
    ///   load on it = g (n.u) n - ya u + force n x w,  torque = turn n x u + yc (w - (n.w) n)
    struct alignas(64) OwnGroup {
        V nx, ny, nz, ya_minus_xa, ya, force, turn, yc;
    };
    struct alignas(64) Slice {
        V c[6];
    };
    /// Upper triangles of symmetric 6x6 blocks, row by row.
    struct alignas(64) Inverse {
        V v[21];
        using stored_as_bytes = void;
    };
    struct alignas(64) DoubleInverse {
        d8 v[21];
    };
    struct Sweep;

    void resize(const Slices& slices);
    void load(const ResistanceMatrix& matrix, Range range);
    void factorise(const ResistanceMatrix& matrix, Range range);
    bool work(const ResistanceProblem& problem, const SlicedVector& b, SlicedVector& x,
              double tolerance, int most, const Team& team, SolveReport& report);

    static constexpr int most_solves = 1'000'000;

    bool indefinite_ = false;   // a diagonal block of the matrix is not positive definite
    int age_ = -1;              // solves since the factor was made; -1: there is none
    int fresh_iterations_ = 0;  // of the first solve with it
    std::vector<OwnGroup> upper_, lower_;
    std::vector<DiagonalSlice<d8>> diagonal_;
    std::vector<DiagonalSlice<V>> narrow_diagonal_;
    std::vector<DoubleInverse> wide_inverse_;  // D^-1 while the factor is made
    std::vector<Inverse> inverse_;             // D^-1
    std::vector<Slice> work_;                  // vectors of one correction
    std::vector<Lanes<V>> rows_;               // a row of eight numbers per slot: t, y
    std::vector<D8> double_rows_;              // a row of eight doubles per slot: x
    std::vector<Lanes<V>> partial_;            // sums of the slices
    std::vector<D8> double_partial_;
    SlicedVector residual_;
};

}
