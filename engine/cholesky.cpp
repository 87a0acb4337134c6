#include "engine/cholesky.h"

#include "engine/error.h"

#include <cholmod.h>
#include <omp.h>
#include <cstring>

namespace sigmaflow {

namespace {

constexpr int block = 6;

void ignore_message(int, const char*, int, const char*) {}

// CHOLMOD opens four OpenMP threads in its loops, whatever the environment says; on small matrices
// they only wait for each other. Without active levels every parallel region of this thread runs
// alone.
class OneThread {
public:
    OneThread() : levels_(omp_get_max_active_levels()) { omp_set_max_active_levels(0); }
    ~OneThread() { omp_set_max_active_levels(levels_); }
    OneThread(const OneThread&) = delete;
    OneThread& operator=(const OneThread&) = delete;

private:
    int levels_;
};

/// Where the entries of the lower triangle of each block lie in the values of the sparse matrix.
struct Slots {
    std::vector<int> diagonal;   // [n * 6]: first entry of each column, contiguous downwards
    std::vector<int> candidate;  // [candidates * 6]: same for the block (row j, column i), i < j
};

}

struct Cholesky::Impl {
    cholmod_common common;
    cholmod_sparse* matrix = nullptr;
    cholmod_factor* factor = nullptr;
    cholmod_dense *right = nullptr, *solution = nullptr, *work_y = nullptr, *work_e = nullptr;
    Slots slots;
    std::vector<DiagonalSlice<d8>> blocks;
    int n = 0;
    std::vector<Candidate> candidates;

    Impl()
    {
        cholmod_start(&common);
        common.supernodal = CHOLMOD_SUPERNODAL;
        common.final_ll = 1;
        common.print = 0;
        common.error_handler = ignore_message;
    }

    ~Impl()
    {
        release_pattern();
        cholmod_free_dense(&right, &common);
        cholmod_free_dense(&solution, &common);
        cholmod_free_dense(&work_y, &common);
        cholmod_free_dense(&work_e, &common);
        cholmod_finish(&common);
    }

    void release_pattern()
    {
        cholmod_free_sparse(&matrix, &common);
        cholmod_free_factor(&factor, &common);
    }

    void check(bool good, const char* what) const
    {
        if (good && common.status >= CHOLMOD_OK) return;
        throw Error(ErrorKind::numerics, "",
                    std::string("CHOLMOD: ") + what + " failed (status " +
                        std::to_string(common.status) + ")");
    }

    std::vector<int> particle_order();
    void factorise();
};

// Fill-reducing order of the particles: AMD or METIS, whichever CHOLMOD finds better.
std::vector<int> Cholesky::Impl::particle_order()
{
    const std::size_t entries = candidates.size() + n;
    cholmod_sparse* graph =
        cholmod_allocate_sparse(n, n, entries, 1, 1, -1, CHOLMOD_PATTERN, &common);
    check(graph, "allocation");
    auto* start = static_cast<int*>(graph->p);
    auto* row = static_cast<int*>(graph->i);
    int entry = 0;
    std::size_t k = 0;
    for (int i = 0; i < n; ++i) {
        start[i] = entry;
        row[entry++] = i;
        for (; k < candidates.size() && candidates[k].i == i; ++k) row[entry++] = candidates[k].j;
    }
    start[n] = entry;
    cholmod_factor* symbolic = cholmod_analyze(graph, &common);
    cholmod_free_sparse(&graph, &common);
    check(symbolic, "ordering");
    const auto* permutation = static_cast<const int*>(symbolic->Perm);
    std::vector<int> order(permutation, permutation + n);
    cholmod_free_factor(&symbolic, &common);
    return order;
}

Cholesky::Cholesky() : impl_(std::make_unique<Impl>()) {}
Cholesky::~Cholesky() = default;
Cholesky::Cholesky(Cholesky&&) noexcept = default;
Cholesky& Cholesky::operator=(Cholesky&&) noexcept = default;

void Cholesky::set_pattern(int n, const std::vector<Candidate>& candidates)
{
    Impl& s = *impl_;
    s.release_pattern();
    s.n = n;
    s.candidates = candidates;
    const std::size_t size = static_cast<std::size_t>(n) * block;
    const std::size_t entries =
        candidates.size() * block * block + static_cast<std::size_t>(n) * (block * (block + 1) / 2);
    s.matrix = cholmod_allocate_sparse(size, size, entries, 1, 1, -1, CHOLMOD_REAL, &s.common);
    s.check(s.matrix, "allocation");
    auto* start = static_cast<int*>(s.matrix->p);
    auto* row = static_cast<int*>(s.matrix->i);
    s.slots.diagonal.resize(size);
    s.slots.candidate.resize(candidates.size() * block);
    int entry = 0;
    std::size_t first = 0;
    for (int i = 0; i < n; ++i) {
        std::size_t last = first;
        while (last < candidates.size() && candidates[last].i == i) ++last;
        for (int c = 0; c < block; ++c) {
            start[i * block + c] = entry;
            s.slots.diagonal[i * block + c] = entry;
            for (int r = c; r < block; ++r) row[entry++] = i * block + r;
            for (std::size_t k = first; k < last; ++k) {
                s.slots.candidate[k * block + c] = entry;
                for (int r = 0; r < block; ++r) row[entry++] = candidates[k].j * block + r;
            }
        }
        first = last;
    }
    start[size] = entry;
    const std::vector<int> order = s.particle_order();
    std::vector<int> permutation(size);
    for (int i = 0; i < n; ++i)
        for (int c = 0; c < block; ++c) permutation[i * block + c] = order[i] * block + c;
    s.common.nmethods = 1;
    s.common.method[0].ordering = CHOLMOD_GIVEN;
    s.factor = cholmod_analyze_p(s.matrix, permutation.data(), nullptr, 0, &s.common);
    s.common.nmethods = 0;  // CHOLMOD's own choice for the next order
    s.check(s.factor, "analysis");
}

void Cholesky::factorise(const ResistanceMatrix& matrix)
{
    Impl& s = *impl_;
    auto* value = static_cast<double*>(s.matrix->x);
    std::memset(value, 0, s.matrix->nzmax * sizeof(double));
    const Slices& slices = *matrix.slices;
    s.blocks.resize(slices.count + 1);
    diagonal_blocks(matrix, {0, slices.count}, s.blocks.data());
    for (int i = 0; i < s.n; ++i) {
        const Mat6 own = diagonal_block(s.blocks.data(), slices.slot[i]);
        for (int c = 0; c < block; ++c)
            std::memcpy(value + s.slots.diagonal[i * block + c], own.data() + c * block + c,
                        (block - c) * sizeof(double));
    }
    for (std::size_t k = 0; k < slices.pair_of.size(); ++k) {
        // the lower triangle holds rows of j and columns of i
        const Mat6 between = off_diagonal_block(matrix, slices.pair_of[k]);
        const Mat6 lower = slices.flipped[k] ? between : Mat6(between.transpose());
        for (int c = 0; c < block; ++c)
            std::memcpy(value + s.slots.candidate[k * block + c], lower.data() + c * block,
                        block * sizeof(double));
    }
    s.factorise();
}

// Of the values in the sparse matrix.
void Cholesky::Impl::factorise()
{
    const OneThread alone;
    const int good = cholmod_factorize(matrix, factor, &common);
    if (common.status == CHOLMOD_NOT_POSDEF) {
        const auto* permutation = static_cast<const int*>(factor->Perm);
        const int pivot = static_cast<int>(factor->minor);
        const int particle = pivot < n * block ? permutation[pivot] / block : -1;
        common.status = CHOLMOD_OK;
        throw Error(ErrorKind::numerics, "",
                    "resistance matrix is not positive definite (first bad pivot at particle " +
                        std::to_string(particle) + ")");
    }
    check(good, "factorisation");
}

void Cholesky::solve(const std::vector<const Velocities*>& right_hand_sides,
                     const std::vector<Velocities*>& solutions)
{
    Impl& s = *impl_;
    const std::size_t size = static_cast<std::size_t>(s.n) * block;
    const std::size_t count = right_hand_sides.size();
    if (!s.right || s.right->nrow != size || s.right->ncol != count) {
        cholmod_free_dense(&s.right, &s.common);
        s.right = cholmod_allocate_dense(size, count, size, CHOLMOD_REAL, &s.common);
        s.check(s.right, "allocation");
    }
    const OneThread alone;
    auto* b = static_cast<double*>(s.right->x);
    for (std::size_t k = 0; k < count; ++k)
        std::memcpy(b + k * size, right_hand_sides[k]->data(), size * sizeof(double));
    s.check(cholmod_solve2(CHOLMOD_A, s.factor, s.right, nullptr, &s.solution, nullptr, &s.work_y,
                           &s.work_e, &s.common),
            "solve");
    const auto* x = static_cast<const double*>(s.solution->x);
    for (std::size_t k = 0; k < count; ++k) {
        solutions[k]->resize(s.n);
        std::memcpy(static_cast<void*>(solutions[k]->data()), x + k * size, size * sizeof(double));
    }
}

int Cholesky::particles() const
{
    return impl_->n;
}

bool Cholesky::has_pattern(const std::vector<Candidate>& candidates) const
{
    return impl_->candidates == candidates;
}

void Cholesky::archive(ArchiveWriter& a)
{
    const Impl& s = *impl_;
    a(s.n, s.candidates);
    a.raw(s.matrix->x, s.matrix->nzmax * sizeof(double));
}

void Cholesky::archive(ArchiveReader& a)
{
    int n = 0;
    std::vector<Candidate> candidates;
    a(n, candidates);
    check_candidates(candidates, n);
    // every block is in the archive: a number of particles that it cannot hold is refused first
    const std::size_t values =
        candidates.size() * block * block + static_cast<std::size_t>(n) * (block * (block + 1) / 2);
    if (n < 1 || a.left() / sizeof(double) < values) ArchiveReader::refuse("ends too early");
    set_pattern(n, candidates);
    a.raw(impl_->matrix->x, values * sizeof(double));
    impl_->factorise();
}

std::string cholesky_version()
{
    int version[3];
    cholmod_version(version);
    return "CHOLMOD " + std::to_string(version[0]) + "." + std::to_string(version[1]) + "." +
           std::to_string(version[2]);
}

}
