#include "engine/pcg.h"

#include <cmath>
#include <cstring>

// Hot loops are compiled for several instruction sets; the processor chooses at start.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define SIGMAFLOW_HOT __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define SIGMAFLOW_HOT
#endif

namespace sigmaflow {

namespace {

constexpr int factor_lifetime = 10;  // solves; the factor hardly ages within so few steps
constexpr int most_iterations = 2000;
constexpr int block = 36;

using Row = double* __restrict;
using ConstRow = const double* __restrict;

/// y = B v for a symmetric 6x6 block.
__attribute__((always_inline)) inline void block_times(ConstRow B, ConstRow v, Row y)
{
    for (int r = 0; r < 6; ++r) y[r] = B[r] * v[0];
    for (int c = 1; c < 6; ++c)
        for (int r = 0; r < 6; ++r) y[r] += B[6 * c + r] * v[c];
}

/// y = A_i v
__attribute__((always_inline)) inline void diagonal_times(const DiagonalBlock& b, ConstRow v, Row y)
{
    const auto &t = b.translation, &r = b.rotation;
    const auto& c = b.coupling;
    y[0] = t[0] * v[0] + t[3] * v[1] + t[4] * v[2] + c[1] * v[5] - c[2] * v[4];
    y[1] = t[3] * v[0] + t[1] * v[1] + t[5] * v[2] + c[2] * v[3] - c[0] * v[5];
    y[2] = t[4] * v[0] + t[5] * v[1] + t[2] * v[2] + c[0] * v[4] - c[1] * v[3];
    y[3] = r[0] * v[3] + r[3] * v[4] + r[4] * v[5] - c[1] * v[2] + c[2] * v[1];
    y[4] = r[3] * v[3] + r[1] * v[4] + r[5] * v[5] - c[2] * v[0] + c[0] * v[2];
    y[5] = r[4] * v[3] + r[5] * v[4] + r[2] * v[5] - c[0] * v[1] + c[1] * v[0];
}

}

/// The arrays of one solve, all [6 n].
struct ConjugateGradients::Sweep {
    int n;
    const SweepPair* pairs;
    const int *first, *column;
    const DiagonalBlock* diagonal;
    const double* inverse;
    const double* f;  // null: no rank-one term
    double weight;

    // load -= L_ji v (rows of j, columns of i)
    __attribute__((always_inline)) static void lower_subtract(const SweepPair& p, ConstRow v,
                                                              Row load)
    {
        const double nx = p.n[0], ny = p.n[1], nz = p.n[2];
        const double nu = p.ya_minus_xa * (nx * v[0] + ny * v[1] + nz * v[2]);
        const double nw = p.yc * (nx * v[3] + ny * v[4] + nz * v[5]);
        load[0] -= nu * nx - p.ya * v[0] - p.yb_i * (ny * v[5] - nz * v[4]);
        load[1] -= nu * ny - p.ya * v[1] - p.yb_i * (nz * v[3] - nx * v[5]);
        load[2] -= nu * nz - p.ya * v[2] - p.yb_i * (nx * v[4] - ny * v[3]);
        load[3] -= p.yc * v[3] - nw * nx - p.yb_j * (ny * v[2] - nz * v[1]);
        load[4] -= p.yc * v[4] - nw * ny - p.yb_j * (nz * v[0] - nx * v[2]);
        load[5] -= p.yc * v[5] - nw * nz - p.yb_j * (nx * v[1] - ny * v[0]);
    }

    // load -= L_ji^T v (rows of i, columns of j)
    __attribute__((always_inline)) static void upper_subtract(const SweepPair& p, ConstRow v,
                                                              Row load)
    {
        const double nx = p.n[0], ny = p.n[1], nz = p.n[2];
        const double nu = p.ya_minus_xa * (nx * v[0] + ny * v[1] + nz * v[2]);
        const double nw = p.yc * (nx * v[3] + ny * v[4] + nz * v[5]);
        load[0] -= nu * nx - p.ya * v[0] + p.yb_j * (ny * v[5] - nz * v[4]);
        load[1] -= nu * ny - p.ya * v[1] + p.yb_j * (nz * v[3] - nx * v[5]);
        load[2] -= nu * nz - p.ya * v[2] + p.yb_j * (nx * v[4] - ny * v[3]);
        load[3] -= p.yc * v[3] - nw * nx + p.yb_i * (ny * v[2] - nz * v[1]);
        load[4] -= p.yc * v[4] - nw * ny + p.yb_i * (nz * v[0] - nx * v[2]);
        load[5] -= p.yc * v[5] - nw * nz + p.yb_i * (nx * v[1] - ny * v[0]);
    }

    /// residual = b - (K - w f f^T) x
    SIGMAFLOW_HOT void residual(ConstRow b, ConstRow x, Row r) const
    {
        double fx = 0;
        if (f)
            for (int k = 0; k < 6 * n; ++k) fx += f[k] * x[k];
        for (int i = 0; i < n; ++i) {
            double y[6];
            diagonal_times(diagonal[i], x + 6 * i, y);
            for (int c = 0; c < 6; ++c) r[6 * i + c] = b[6 * i + c] - y[c];
            if (f)
                for (int c = 0; c < 6; ++c) r[6 * i + c] += weight * fx * f[6 * i + c];
        }
        for (int i = 0; i < n; ++i) {
            double own[6];
            std::memcpy(own, r + 6 * i, sizeof own);
            for (int k = first[i]; k < first[i + 1]; ++k) {
                upper_subtract(pairs[k], x + 6 * column[k], own);
                lower_subtract(pairs[k], x + 6 * i, r + 6 * column[k]);
            }
            std::memcpy(r + 6 * i, own, sizeof own);
        }
    }

    /// y = (D + L)^-1 c; c is overwritten by D y.
    SIGMAFLOW_HOT void forward(Row c, Row y) const
    {
        for (int i = 0; i < n; ++i) {
            block_times(inverse + block * i, c + 6 * i, y + 6 * i);
            for (int k = first[i]; k < first[i + 1]; ++k)
                lower_subtract(pairs[k], y + 6 * i, c + 6 * column[k]);
        }
    }

    /// t = (D + L)^-T p, u = D t; returns f.t.
    SIGMAFLOW_HOT double backward(ConstRow p, Row u, Row t) const
    {
        double ft = 0;
        for (int i = n - 1; i >= 0; --i) {
            double own[6];
            std::memcpy(own, p + 6 * i, sizeof own);
            for (int k = first[i]; k < first[i + 1]; ++k)
                upper_subtract(pairs[k], t + 6 * column[k], own);
            std::memcpy(u + 6 * i, own, sizeof own);
            block_times(inverse + block * i, own, t + 6 * i);
            if (f)
                for (int c = 0; c < 6; ++c) ft += f[6 * i + c] * t[6 * i + c];
        }
        return ft;
    }

    /// q = t + (D + L)^-1 c, Dq = u + D (D + L)^-1 c, with c = p + (A_D - 2 D) t - w f (f.t);
    /// returns p.q.
    SIGMAFLOW_HOT double forward_of_product(ConstRow p, ConstRow t, ConstRow u, double ft, Row c,
                                            Row q, Row Dq) const
    {
        for (int i = 0; i < n; ++i) {
            double y[6];
            diagonal_times(diagonal[i], t + 6 * i, y);
            for (int k = 0; k < 6; ++k) c[6 * i + k] = p[6 * i + k] + y[k] - 2 * u[6 * i + k];
            if (f)
                for (int k = 0; k < 6; ++k) c[6 * i + k] -= weight * ft * f[6 * i + k];
        }
        double pq = 0;
        for (int i = 0; i < n; ++i) {
            double y[6];
            block_times(inverse + block * i, c + 6 * i, y);
            for (int k = first[i]; k < first[i + 1]; ++k)
                lower_subtract(pairs[k], y, c + 6 * column[k]);
            for (int k = 0; k < 6; ++k) {
                q[6 * i + k] = t[6 * i + k] + y[k];
                Dq[6 * i + k] = u[6 * i + k] + c[6 * i + k];
                pq += p[6 * i + k] * q[6 * i + k];
            }
        }
        return pq;
    }

    /// x += alpha t, r -= alpha q, z -= alpha Dq; returns r.z.
    SIGMAFLOW_HOT double update(double alpha, ConstRow t, ConstRow q, ConstRow Dq, Row x, Row r,
                                Row z) const
    {
        double rz = 0;
        for (int k = 0; k < 6 * n; ++k) {
            x[k] += alpha * t[k];
            r[k] -= alpha * q[k];
            z[k] -= alpha * Dq[k];
            rz += r[k] * z[k];
        }
        return rz;
    }
};

void ConjugateGradients::load(const ResistanceMatrix& m)
{
    n_ = m.size();
    first_.assign(n_ + 1, 0);
    column_.resize(m.pairs.size());
    pairs_.resize(m.pairs.size());
    diagonal_ = m.diagonal.data();
    for (std::size_t k = 0; k < m.pairs.size(); ++k) {
        const PairBlock& p = m.pairs[k];
        ++first_[p.i + 1];
        column_[k] = p.j;
        pairs_[k] = {
            {p.normal.x(), p.normal.y(), p.normal.z()}, p.ya - p.xa, p.ya, p.yb11, p.yb21, p.yc12};
    }
    for (int i = 0; i < n_; ++i) first_[i + 1] += first_[i];
}

void ConjugateGradients::refresh_factor(const ResistanceMatrix& m)
{
    std::vector<Mat6> D;
    D.reserve(n_);
    for (const DiagonalBlock& b : m.diagonal) D.push_back(full(b));
    inverse_.resize(static_cast<std::size_t>(n_) * block);
    for (int i = 0; i < n_; ++i) {
        Eigen::LLT<Mat6> factor(D[i]);
        if (factor.info() != Eigen::Success) factor.compute(full(m.diagonal[i]));
        const Mat6 inverse = factor.solve(Mat6::Identity());
        const Mat6 symmetric = 0.5 * (inverse + inverse.transpose());
        std::memcpy(inverse_.data() + block * i, symmetric.data(), block * sizeof(double));
        for (int k = first_[i]; k < first_[i + 1]; ++k) {
            const Mat6 L = off_diagonal(m.pairs[k]).transpose();
            D[column_[k]].noalias() -= L * symmetric * L.transpose();
        }
    }
}

bool ConjugateGradients::solve(const ResistanceProblem& problem, const Velocities& b, Velocities& x,
                               double tolerance, SolveReport& report)
{
    load(problem.matrix);
    if (age_ < 0 || age_ >= factor_lifetime ||
        inverse_.size() != static_cast<std::size_t>(n_) * block) {
        refresh_factor(problem.matrix);
        age_ = 0;
    }
    ++age_;
    const std::size_t size = static_cast<std::size_t>(n_) * 6;
    work_.resize(8 * size);
    double *r = work_.data(), *z = r + size, *p = z + size, *t = p + size, *u = t + size,
           *q = u + size, *Dq = q + size, *c = Dq + size;
    const Sweep sweep{n_,
                      pairs_.data(),
                      first_.data(),
                      column_.data(),
                      diagonal_,
                      inverse_.data(),
                      problem.direction ? problem.direction->data()->data() : nullptr,
                      problem.weight};
    const double* right = b.data()->data();
    double* solution = x.data()->data();
    const auto dot_of = [size](const double* v, const double* w) {
        double sum = 0;
        for (std::size_t k = 0; k < size; ++k) sum += v[k] * w[k];
        return sum;
    };

    // size of the right-hand side in the norm of the preconditioner
    std::memcpy(c, right, size * sizeof(double));
    sweep.forward(c, r);
    const double goal = tolerance * tolerance * dot_of(r, c);

    sweep.residual(right, solution, z);
    sweep.forward(z, r);  // z = D r
    double rho = dot_of(r, z);
    std::memcpy(p, z, size * sizeof(double));
    report.iterations = 0;
    while (rho > goal) {
        if (report.iterations == most_iterations || !std::isfinite(rho)) return false;
        const double ft = sweep.backward(p, u, t);
        const double curvature = sweep.forward_of_product(p, t, u, ft, c, q, Dq);
        if (!(curvature > 0)) return false;
        const double next = sweep.update(rho / curvature, t, q, Dq, solution, r, z);
        const double beta = next / rho;
        for (std::size_t k = 0; k < size; ++k) p[k] = z[k] + beta * p[k];
        rho = next;
        ++report.iterations;
    }
    sweep.residual(right, solution, z);
    const double b2 = dot_of(right, right);
    report.residual = b2 > 0 ? std::sqrt(dot_of(z, z) / b2) : 0;
    return true;
}

}
