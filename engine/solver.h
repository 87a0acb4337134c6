// engine/solver.h -- the resistance problem (R - w f f^T) x = b, three ways behind one interface.
//
// R is sparse, symmetric and positive definite; the optional rank-one term comes from stress
// control (evaluation.h).
//   pcg              conjugate gradients, preconditioned by a block incomplete factor
//                    (engine/pcg.h); the cost grows like n
//   cholesky         factorises R anew (engine/cholesky.h); f by the Sherman-Morrison formula
//   lagged_cholesky  conjugate gradients, preconditioned by the Cholesky factor of an earlier R,
//                    which is made anew when it has aged
// The true residual of every solve is computed, reported and bounded: no solution leaves without
// one in its limit, so a value that is not finite in R, b or the guess cannot pass for a result.
// The limit of an iteration is largest_excess times its tolerance, and 1 in any case; that of a
// direct solution is largest_direct_residual. An iteration that does not reach its tolerance or its
// limit falls back to Cholesky; the report says so. A guess that is not finite is not used.
// Measured (README.md): 0.5 to 11 times the tolerance, 1000 times where springs are so stiff that
// the residual is all theirs; direct solutions 1e-15 to 1e-11.
// Errors: numerics (R not positive definite, b not finite, residual of a direct solution beyond its
// limit).
#pragma once
#include "engine/archive.h"
#include "engine/pairs.h"
#include "engine/resistance_matrix.h"
#include "engine/types.h"

#include <memory>
#include <string>
#include <vector>

namespace sigmaflow {

enum class SolverKind { pcg, cholesky, lagged_cholesky };

struct SolverSettings {
    SolverKind kind = SolverKind::pcg;
    double tolerance = 1e-5;  // of the residual, relative, in the norm of the preconditioner (0, 1)
    int threads = 1;          // of evaluation and pcg; results do not depend on it [1, 256]
};

inline constexpr double largest_excess = 1000, largest_direct_residual = 1e-6;

struct SolveReport {
    int iterations = 0;
    double residual = 0;  // |b - A x|/|b|, the largest if there are several
    bool fell_back = false;
};

/// R - weight direction direction^T
struct ResistanceProblem {
    const ResistanceMatrix& matrix;
    const SlicedVector* direction = nullptr;
    double weight = 0;
};

class ResistanceSolver {
public:
    explicit ResistanceSolver(const SolverSettings& settings);
    ~ResistanceSolver();
    ResistanceSolver(ResistanceSolver&&) noexcept;
    ResistanceSolver& operator=(ResistanceSolver&&) noexcept;

    /// Sparsity pattern for n particles; the slices of the matrices to come were made of these
    /// candidates.
    void set_pattern(int n, const std::vector<Candidate>& candidates);

    /// x: a guess on entry (any size: not used), the solution on return. `share` of the tolerance.
    SolveReport solve(const ResistanceProblem& problem, const SlicedVector& b, SlicedVector& x,
                      double share = 1);

    /// Exact solutions for several right-hand sides at once, without a rank-one term.
    SolveReport solve_directly(const ResistanceMatrix& matrix,
                               const std::vector<const Velocities*>& b,
                               const std::vector<Velocities*>& x);

    /// What the next solve takes from earlier ones: factors of earlier matrices and their age. To
    /// be restored after set_pattern. Errors: input (a factor of other particles or pairs).
    void save(ArchiveWriter& archive);
    void restore(ArchiveReader& archive);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// e.g. "CHOLMOD 3.0.14"
std::string solver_version();

}
