#include "engine/pcg.h"

#include "engine/lean_resize.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sigmaflow {

namespace {

constexpr int factor_lifetime = 10;  // solves at most
constexpr int aged = 2;              // iterations more than with the fresh factor
constexpr int most_iterations = 2000;
constexpr int most_corrections = 40;
// least residual after one correction, relative
template <class V>
constexpr double reduction = sizeof(Scalar<V>) == 4 ? 1e-4 : 1e-10;
constexpr int patience = 60;           // iterations without progress
constexpr double margin = 0.8;         // of the goal: what a correction aims at
constexpr double least_pivot = 1e-12;  // relative; less is rounding
constexpr double least_drag = 0.02;    // single precision cannot resolve less [eta0 a, eta0 a^3]

template <class V>
struct Motion {
    Triple<V> u, w;
};

/// Position of (row, column), row <= column, in the packed upper triangle.
constexpr int packed(int row, int column)
{
    return row * 6 - row * (row - 1) / 2 + column - row;
}

template <class V>
SIGMAFLOW_INLINE void symmetric_times(const V* B, const V* x, V* y)
{
    for (int r = 0; r < 6; ++r) {
        V sum = B[packed(r, r)] * x[r];
        for (int c = 0; c < 6; ++c)
            if (c != r) sum += B[c > r ? packed(r, c) : packed(c, r)] * x[c];
        y[r] = sum;
    }
}

template <class V>
SIGMAFLOW_INLINE void diagonal_times(const DiagonalSlice<V>& b, const V* v, V* y)
{
    const V *t = b.translation, *r = b.rotation, *c = b.coupling;
    y[0] = t[0] * v[0] + t[3] * v[1] + t[4] * v[2] + c[1] * v[5] - c[2] * v[4];
    y[1] = t[3] * v[0] + t[1] * v[1] + t[5] * v[2] + c[2] * v[3] - c[0] * v[5];
    y[2] = t[4] * v[0] + t[5] * v[1] + t[2] * v[2] + c[0] * v[4] - c[1] * v[3];
    y[3] = r[0] * v[3] + r[3] * v[4] + r[4] * v[5] - c[1] * v[2] + c[2] * v[1];
    y[4] = r[3] * v[3] + r[1] * v[4] + r[5] * v[5] - c[2] * v[0] + c[0] * v[2];
    y[5] = r[4] * v[3] + r[5] * v[4] + r[2] * v[5] - c[0] * v[1] + c[1] * v[0];
}

template <class V>
SIGMAFLOW_INLINE double sum_of(const Lanes<V>* partial, int count)
{
    d8 even{}, odd{};
    int k = 0;
    for (; k + 1 < count; k += 2) {
        even += widened(partial[k].v);
        odd += widened(partial[k + 1].v);
    }
    if (k < count) even += widened(partial[k].v);
    return total(even + odd);
}

/// One symmetric block in lanes, as a full matrix.
template <class V>
struct Full {
    V m[6][6];
};

SIGMAFLOW_INLINE double smallest(const d8& x)
{
    double least = x[0];
    for (int l = 1; l < lanes; ++l) least = x[l] < least ? x[l] : least;
    return least;
}

// Inverse of a symmetric positive definite block by L D L^T; worst: the smallest pivot relative to
// the entry that it came from.
template <class V>
SIGMAFLOW_INLINE void invert(const Full<V>& A, V* inverse, V& worst)
{
    V L[6][6], d[6], id[6];
    worst = spread<V>(1);
    for (int j = 0; j < 6; ++j) {
        V pivot = A.m[j][j];
        for (int k = 0; k < j; ++k) pivot -= L[j][k] * L[j][k] * d[k];
        const V relative = pivot / A.m[j][j];
        worst = A.m[j][j] > 0 ? (relative < worst ? relative : worst) : spread<V>(-1);
        d[j] = pivot;
        id[j] = 1 / pivot;
        for (int i = j + 1; i < 6; ++i) {
            V sum = A.m[i][j];
            for (int k = 0; k < j; ++k) sum -= L[i][k] * L[j][k] * d[k];
            L[i][j] = sum * id[j];
        }
    }
    V X[6][6];  // L^-1
    for (int c = 0; c < 6; ++c) {
        for (int r = 0; r < 6; ++r) X[r][c] = spread<V>(r == c);
        for (int r = c + 1; r < 6; ++r)
            for (int k = c; k < r; ++k) X[r][c] -= L[r][k] * X[k][c];
    }
    for (int r = 0; r < 6; ++r)
        for (int c = r; c < 6; ++c) {
            V sum{};
            for (int k = c; k < 6; ++k) sum += X[k][r] * X[k][c] * id[k];
            inverse[packed(r, c)] = sum;
        }
}

}

/// The loops over slices of one correction.
template <class V>
struct ConjugateGradients<V>::Sweep {
    const Slices* slices;
    const OwnGroup *upper, *lower;
    const DiagonalSlice<V>* diagonal;
    const Inverse* inverse;
    const Slice* f;  // null: no rank-one term
    Slice *p, *r, *z, *t, *u, *q, *Dq, *x;
    V* rows;
    Lanes<V>* partial;
    Lanes<V>* second_partial;

    // load -= off-diagonal block times the velocities of the other particles
    SIGMAFLOW_INLINE static void subtract_block(const OwnGroup& g, const V* rows, const int* slot,
                                                Motion<V>& load)
    {
        Motion<V> v;
        gather_rows(rows, slot, v.u, v.w);
        const Triple<V> n{g.nx, g.ny, g.nz};
        const V nu = g.ya_minus_xa * dot(n, v.u), nw = g.yc * dot(n, v.w);
        load.u = load.u - (nu * n - g.ya * v.u + g.force * cross(n, v.w));
        load.w = load.w - (g.turn * cross(n, v.u) + g.yc * v.w - nw * n);
    }

    SIGMAFLOW_INLINE void subtract_upper(int k, Motion<V>& load) const
    {
        for (int g = slices->upper[k]; g < slices->upper[k + 1]; ++g)
            subtract_block(upper[g], rows, slices->second.data() + g * lanes, load);
    }

    SIGMAFLOW_INLINE void subtract_lower(int k, Motion<V>& load) const
    {
        for (int g = slices->lower[k]; g < slices->lower[k + 1]; ++g)
            subtract_block(lower[g], rows, slices->lower_slot.data() + g * lanes, load);
    }

    /// y = D^-1 load, also as rows.
    SIGMAFLOW_INLINE Motion<V> divided(int k, const Motion<V>& load) const
    {
        const V v[6] = {load.u.x, load.u.y, load.u.z, load.w.x, load.w.y, load.w.z};
        V y[6];
        symmetric_times(inverse[k].v, v, y);
        const Motion<V> result{{y[0], y[1], y[2]}, {y[3], y[4], y[5]}};
        sigmaflow::write_rows(result.u, result.w, rows + static_cast<std::size_t>(lanes) * k);
        return result;
    }

    SIGMAFLOW_INLINE static Motion<V> read(const Slice& s)
    {
        return {{s.c[0], s.c[1], s.c[2]}, {s.c[3], s.c[4], s.c[5]}};
    }

    SIGMAFLOW_INLINE static void write(const Motion<V>& m, Slice& s)
    {
        s = {{m.u.x, m.u.y, m.u.z, m.w.x, m.w.y, m.w.z}};
    }

    /// y = (D + L)^-1 c, z = D y; partial sums of y.z.
    SIGMAFLOW_HOT void forward(const Slice* c, Slice* y, Slice* Dy, Range range) const
    {
        for (int k = range.begin; k < range.end; ++k) {
            Motion<V> load = read(c[k]);
            subtract_lower(k, load);
            const Motion<V> result = divided(k, load);
            write(load, Dy[k]);
            write(result, y[k]);
            partial[k].v = dot(load.u, result.u) + dot(load.w, result.w);
        }
    }

    /// p = z + beta p, t = (D + L)^-T p, u = D t; partial sums of f.t.
    SIGMAFLOW_HOT void backward(Scalar<V> beta, Range range) const
    {
        for (int k = range.end - 1; k >= range.begin; --k) {
            for (int c = 0; c < 6; ++c) p[k].c[c] = z[k].c[c] + beta * p[k].c[c];
            Motion<V> load = read(p[k]);
            subtract_upper(k, load);
            write(load, u[k]);
            write(divided(k, load), t[k]);
            if (f) {
                V sum{};
                for (int c = 0; c < 6; ++c) sum += f[k].c[c] * t[k].c[c];
                partial[k].v = sum;
            }
        }
    }

    /// q = t + (D + L)^-1 c, Dq = u + D (D + L)^-1 c, with c = p + (A_D - 2 D) t - w f (f.t);
    /// partial sums of p.q.
    SIGMAFLOW_HOT void forward_of_product(Scalar<V> weighted_ft, Range range) const
    {
        for (int k = range.begin; k < range.end; ++k) {
            V c[6];
            diagonal_times(diagonal[k], t[k].c, c);
            for (int e = 0; e < 6; ++e) {
                c[e] += p[k].c[e] - 2 * u[k].c[e];
                if (f) c[e] -= weighted_ft * f[k].c[e];
            }
            Motion<V> load{{c[0], c[1], c[2]}, {c[3], c[4], c[5]}};
            subtract_lower(k, load);
            const Motion<V> y = divided(k, load), forward_t = read(t[k]), forward_u = read(u[k]);
            write({forward_t.u + y.u, forward_t.w + y.w}, q[k]);
            write({forward_u.u + load.u, forward_u.w + load.w}, Dq[k]);
            V sum{};
            for (int e = 0; e < 6; ++e) sum += p[k].c[e] * q[k].c[e];
            second_partial[k].v = sum;
        }
    }

    /// x += alpha t, r -= alpha q, z -= alpha Dq; partial sums of r.z.
    SIGMAFLOW_HOT void update(Scalar<V> alpha, Range range) const
    {
        for (int k = range.begin; k < range.end; ++k) {
            V sum{};
            for (int c = 0; c < 6; ++c) {
                x[k].c[c] += alpha * t[k].c[c];
                r[k].c[c] -= alpha * q[k].c[c];
                z[k].c[c] -= alpha * Dq[k].c[c];
                sum += r[k].c[c] * z[k].c[c];
            }
            partial[k].v = sum;
        }
    }
};

template <class V>
void ConjugateGradients<V>::resize(const Slices& s)
{
    const std::size_t count = s.count + 1;
    lean_resize(upper_, s.groups());
    lean_resize(lower_, s.lower_pair.size() / lanes);
    diagonal_.resize(count);
    narrow_diagonal_.resize(count);
    if (inverse_.size() != count) age_ = -1;
    inverse_.resize(count);
    wide_inverse_.resize(count);
    work_.resize(10 * count);
    rows_.resize(lanes * count);
    double_rows_.resize(lanes * count);
    std::fill(rows_.end() - lanes, rows_.end(), Lanes<V>{});
    std::fill(double_rows_.end() - lanes, double_rows_.end(), D8{});
    partial_.resize(2 * count);
    double_partial_.resize(2 * count);
    residual_.resize(count);
}

template <class V>
SIGMAFLOW_HOT void ConjugateGradients<V>::load(const ResistanceMatrix& m, Range range)
{
    const Slices& s = *m.slices;
    for (int k = range.begin; k < range.end; ++k) {
        for (int g = s.upper[k]; g < s.upper[k + 1]; ++g) {
            const PairGroup& p = m.pairs[g];
            upper_[g] = {narrowed<V>(p.nx),        narrowed<V>(p.ny),  narrowed<V>(p.nz),
                         narrowed<V>(p.ya - p.xa), narrowed<V>(p.ya),  narrowed<V>(p.yb21),
                         narrowed<V>(p.yb11),      narrowed<V>(p.yc12)};
        }
        for (int g = s.lower[k]; g < s.lower[k + 1]; ++g) {
            const auto member = [&](int index) {
                return pick(m.pairs.data(), s.lower_pair.data() + g * lanes, index);
            };
            lower_[g] = {narrowed<V>(-member(0)), narrowed<V>(-member(1)),
                         narrowed<V>(-member(2)), narrowed<V>(member(4) - member(3)),
                         narrowed<V>(member(4)),  narrowed<V>(member(5)),
                         narrowed<V>(member(6)),  narrowed<V>(member(8))};
        }
    }
    diagonal_blocks(m, range, diagonal_.data());
    for (int k = range.begin; k < range.end; ++k) {
        // refinement makes up for the drag that is added here
        for (int c = 0; c < 3 && sizeof(Scalar<V>) == 4; ++c) {
            diagonal_[k].translation[c] += larger(least_drag - m.drag[2 * k].v, d8{});
            diagonal_[k].rotation[c] += larger(least_drag - m.drag[2 * k + 1].v, d8{});
        }
        for (int c = 0; c < 6; ++c) {
            narrow_diagonal_[k].translation[c] = narrowed<V>(diagonal_[k].translation[c]);
            narrow_diagonal_[k].rotation[c] = narrowed<V>(diagonal_[k].rotation[c]);
        }
        for (int c = 0; c < 3; ++c)
            narrow_diagonal_[k].coupling[c] = narrowed<V>(diagonal_[k].coupling[c]);
    }
}

namespace {

SIGMAFLOW_INLINE void fill(const DiagonalSlice<d8>& b, Full<d8>& A)
{
    const d8 *t = b.translation, *r = b.rotation, *c = b.coupling;
    const d8 zero{};
    const d8 rows[6][6] = {
        {t[0], t[3], t[4], zero, -c[2], c[1]}, {t[3], t[1], t[5], c[2], zero, -c[0]},
        {t[4], t[5], t[2], -c[1], c[0], zero}, {zero, c[2], -c[1], r[0], r[3], r[4]},
        {-c[2], zero, c[0], r[3], r[1], r[5]}, {c[1], -c[0], zero, r[4], r[5], r[2]}};
    for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) A.m[i][j] = rows[i][j];
}

// the off-diagonal block times one column
SIGMAFLOW_INLINE void block_times(const Triple<d8>& n, const d8& g, const d8& ya, const d8& force,
                                  const d8& turn, const d8& yc, const d8* v, d8* y)
{
    const Triple<d8> u{v[0], v[1], v[2]}, w{v[3], v[4], v[5]};
    const d8 nu = g * dot(n, u), nw = yc * dot(n, w);
    const Triple<d8> F = nu * n - ya * u + force * cross(n, w);
    const Triple<d8> T = turn * cross(n, u) + yc * w - nw * n;
    y[0] = F.x;
    y[1] = F.y;
    y[2] = F.z;
    y[3] = T.x;
    y[4] = T.y;
    y[5] = T.z;
}

}

// D_i = A_i - sum over the earlier particles of L_ij D_j^-1 L_ij^T
template <class V>
SIGMAFLOW_HOT void ConjugateGradients<V>::factorise(const ResistanceMatrix& m, Range range)
{
    const Slices& s = *m.slices;
    for (int k = range.begin; k < range.end; ++k) {
        Full<d8> A;
        fill(diagonal_[k], A);
        for (int group = s.lower[k]; group < s.lower[k + 1]; ++group) {
            const OwnGroup& own = lower_[group];
            const Triple<d8> n{widened(own.nx), widened(own.ny), widened(own.nz)};
            const d8 g = widened(own.ya_minus_xa), ya = widened(own.ya), force = widened(own.force),
                     turn = widened(own.turn), yc = widened(own.yc);
            d8 inverse[21];
            for (int l = 0; l < lanes; ++l) {
                const int slot = s.lower_slot[group * lanes + l];
                const double* from =
                    reinterpret_cast<const double*>(wide_inverse_.data() + slot / lanes) +
                    slot % lanes;
                for (int e = 0; e < 21; ++e) inverse[e][l] = from[e * lanes];
            }
            // S = L D^-1, column c = L (D^-1 e_c); then L S^T
            d8 S[6][6];
            for (int c = 0; c < 6; ++c) {
                d8 column[6], y[6];
                for (int r = 0; r < 6; ++r)
                    column[r] = inverse[r <= c ? packed(r, c) : packed(c, r)];
                block_times(n, g, ya, force, turn, yc, column, y);
                for (int r = 0; r < 6; ++r) S[r][c] = y[r];
            }
            for (int r = 0; r < 6; ++r) {
                d8 y[6];
                block_times(n, g, ya, force, turn, yc, S[r], y);
                for (int c = r; c < 6; ++c) A.m[c][r] -= y[c];
            }
        }
        d8 worst;
        invert(A, wide_inverse_[k].v, worst);
        if (!(smallest(worst) > least_pivot)) {  // not positive definite: A_i alone
            Full<d8> own;
            fill(diagonal_[k], own);
            d8 own_inverse[21], own_worst;
            invert(own, own_inverse, own_worst);
            if (!(smallest(own_worst) > 0)) {
#pragma omp atomic write
                indefinite_ = true;
            }
            for (int e = 0; e < 21; ++e)
                wide_inverse_[k].v[e] =
                    worst > least_pivot ? wide_inverse_[k].v[e] : own_inverse[e];
        }
        for (int e = 0; e < 21; ++e) inverse_[k].v[e] = narrowed<V>(wide_inverse_[k].v[e]);
    }
}

template <class V>
bool ConjugateGradients<V>::solve(const ResistanceProblem& problem, const SlicedVector& b,
                                  SlicedVector& x, double tolerance, int threads,
                                  SolveReport& report)
{
    resize(*problem.matrix.slices);
    bool good = false;
    indefinite_ = false;
    if (age_ >= factor_lifetime) age_ = -1;
    const auto attempt = [&](int most) {
        with_team(threads, [&](const Team& team) {
            SolveReport own;
            const bool reached = work(problem, b, x, tolerance, most, team, own);
            if (team.rank == 0) {
                good = reached;
                report.iterations += own.iterations;
                report.residual = own.residual;
            }
        });
    };
    const bool fresh = age_ < 0;
    attempt(fresh ? most_iterations : 2 * fresh_iterations_ + 10);
    if (!good && !fresh && !indefinite_) {  // springs that came into the matrix make it another one
        age_ = -1;
        attempt(most_iterations);
    }
    if (age_ == 0) fresh_iterations_ = report.iterations;
    ++age_;
    if (report.iterations >= fresh_iterations_ + aged) age_ = -1;
    return good;
}

namespace {

// partial sums of r.r, b.b
SIGMAFLOW_HOT void square(const SlicedVector& v, Range range, D8* partial)
{
    for (int k = range.begin; k < range.end; ++k) {
        d8 sum{};
        for (int c = 0; c < 6; ++c) sum += v[k].c[c] * v[k].c[c];
        partial[k].v = sum;
    }
}

SIGMAFLOW_HOT void product(const SlicedVector& v, const SlicedVector& w, Range range, D8* partial)
{
    for (int k = range.begin; k < range.end; ++k) {
        d8 sum{};
        for (int c = 0; c < 6; ++c) sum += v[k].c[c] * w[k].c[c];
        partial[k].v = sum;
    }
}

}

// Every member of the team goes through all of this and decides the same, from the same sums.
template <class V>
bool ConjugateGradients<V>::work(const ResistanceProblem& problem, const SlicedVector& b,
                                 SlicedVector& x, double tolerance, int most, const Team& team,
                                 SolveReport& report)
{
    const ResistanceMatrix& matrix = problem.matrix;
    const Slices& s = *matrix.slices;
    const std::size_t stride = s.count + 1;
    const auto own = [&](const auto& phase) { team.own(s, phase); };
    const auto by_colours = [&](bool forwards, const auto& phase) {
        team.by_colours(s, forwards, phase);
    };
    const auto own_slices = [&](const auto& phase) {
        own([&](Range range) {
            for (int k = range.begin; k < range.end; ++k) phase(k);
        });
    };

    own([&](Range range) { load(matrix, range); });
    team.barrier();
    if (age_ < 0) {
        by_colours(true, [&](Range range) { factorise(matrix, range); });
        team.barrier();
        if (team.rank == 0) age_ = 0;
    }
    if (indefinite_) return false;
    Slice* next = work_.data();
    const auto vector = [&] { return std::exchange(next, next + stride); };
    Sweep sweep{.slices = &s,
                .upper = upper_.data(),
                .lower = lower_.data(),
                .diagonal = narrow_diagonal_.data(),
                .inverse = inverse_.data(),
                .f = nullptr,
                .p = vector(),
                .r = vector(),
                .z = vector(),
                .t = vector(),
                .u = vector(),
                .q = vector(),
                .Dq = vector(),
                .x = vector(),
                .rows = &rows_.data()->v,
                .partial = partial_.data(),
                .second_partial = partial_.data() + stride};
    Slice* right = vector();
    Slice* f = vector();
    if (problem.direction) {
        const SlicedVector& direction = *problem.direction;
        own_slices([&](int k) {
            for (int c = 0; c < 6; ++c) f[k].c[c] = narrowed<V>(direction[k].c[c]);
        });
        sweep.f = f;
    }
    double* rows = reinterpret_cast<double*>(double_rows_.data());
    D8 *first_sum = double_partial_.data(), *second_sum = first_sum + stride;

    // size of the right-hand side, and in the norm of the preconditioner
    own([&](Range range) { square(b, range, first_sum); });
    team.barrier();
    const double b2 = sum_of(first_sum, s.count);
    if (!(b2 > 0)) {
        own_slices([&](int k) { x[k] = Slice6{}; });
        return std::isfinite(b2);
    }
    const auto narrow = [&](const SlicedVector& from, double size) {
        own_slices([&](int k) {
            for (int c = 0; c < 6; ++c) right[k].c[c] = narrowed<V>(from[k].c[c] / size);
        });
        team.barrier();
        by_colours(true, [&](Range range) { sweep.forward(right, sweep.r, sweep.z, range); });
        return sum_of(sweep.partial, s.count);
    };
    const double goal = tolerance * tolerance * narrow(b, std::sqrt(b2)) * b2;

    double before = 0;
    for (int correction = 0;; ++correction) {
        team.barrier();
        own([&](Range range) {
            write_rows(x, range, rows);
            if (problem.direction) product(*problem.direction, x, range, first_sum);
        });
        team.barrier();
        own([&](Range range) { subtract_product(matrix, x, rows, b, range, residual_); });
        if (problem.direction) {
            const double fx = problem.weight * sum_of(first_sum, s.count);
            own_slices([&](int k) {
                for (int c = 0; c < 6; ++c) residual_[k].c[c] += fx * (*problem.direction)[k].c[c];
            });
        }
        own([&](Range range) { square(residual_, range, second_sum); });
        team.barrier();
        const double r2 = sum_of(second_sum, s.count);
        report.residual = std::sqrt(r2 / b2);
        if (!std::isfinite(r2)) return false;
        if (r2 == 0) return true;
        const double size = std::sqrt(r2);
        const double start = narrow(residual_, size);
        if (!(start >= 0) || !std::isfinite(start)) return false;
        const double now = start * r2;
        if (now <= goal) return true;
        if (correction == most_corrections || (correction && now > 0.8 * before)) return false;
        before = now;

        own_slices([&](int k) { sweep.p[k] = sweep.x[k] = Slice{}; });
        const double enough = std::max(margin * goal / r2, reduction<V> * reduction<V> * start);
        double rho = start, beta = 0, best = start;
        bool reached = true;
        for (int since_best = 0; rho > enough; ++since_best) {
            if (since_best == patience || report.iterations == most) {
                reached = false;
                break;
            }
            team.barrier();
            by_colours(false,
                       [&](Range range) { sweep.backward(static_cast<Scalar<V>>(beta), range); });
            const double ft = sweep.f ? sum_of(sweep.partial, s.count) : 0;
            by_colours(true, [&](Range range) {
                sweep.forward_of_product(static_cast<Scalar<V>>(problem.weight * ft), range);
            });
            const double curvature = sum_of(sweep.second_partial, s.count);
            if (!(curvature > 0) || !std::isfinite(curvature)) return false;
            team.barrier();
            own([&](Range range) { sweep.update(static_cast<Scalar<V>>(rho / curvature), range); });
            team.barrier();
            const double next_rho = sum_of(sweep.partial, s.count);
            if (!std::isfinite(next_rho)) return false;
            beta = next_rho / rho;
            rho = next_rho;
            ++report.iterations;
            if (rho < 0.9 * best) {
                best = rho;
                since_best = 0;
            }
        }
        own_slices([&](int k) {
            for (int c = 0; c < 6; ++c) x[k].c[c] += size * widened(sweep.x[k].c[c]);
        });
        if (!reached) return false;
    }
}

template class ConjugateGradients<f8>;
template class ConjugateGradients<d8>;

}
