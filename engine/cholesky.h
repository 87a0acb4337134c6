// engine/cholesky.h -- sparse Cholesky factor of the resistance matrix.
//
// CHOLMOD (Chen, Davis, Hager, Rajamanickam, ACM Trans. Math. Softw. 35, 22, 2008), supernodal. The
// fill-reducing order is found on the graph of the particles (a sixth of the size of the matrix)
// and kept, with the symbolic analysis, as long as the pattern (the candidate pairs) stays the
// same. Errors: numerics "not positive definite" with the particle of the first bad pivot; never a
// fall-back.
#pragma once
#include "engine/archive.h"
#include "engine/pairs.h"
#include "engine/resistance_matrix.h"

#include <memory>
#include <string>
#include <vector>

namespace sigmaflow {

class Cholesky {
public:
    Cholesky();
    ~Cholesky();
    Cholesky(Cholesky&&) noexcept;
    Cholesky& operator=(Cholesky&&) noexcept;

    /// Sparsity pattern for n particles; the pairs of a matrix are these candidates.
    void set_pattern(int n, const std::vector<Candidate>& candidates);

    /// Numerical factorisation.
    void factorise(const ResistanceMatrix& matrix);

    /// Solves for several right-hand sides at once, with the last factor; each [n].
    void solve(const std::vector<const Velocities*>& right_hand_sides,
               const std::vector<Velocities*>& solutions);

    int particles() const;
    bool has_pattern(const std::vector<Candidate>& candidates) const;
    /// The last matrix that was factorised, with its pattern; restoring factorises it again, which
    /// gives the same factor bit by bit. Errors: input, numerics.
    void archive(ArchiveWriter& a);
    void archive(ArchiveReader& a);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

std::string cholesky_version();

}
