#include "engine/pcg.h"

#include <algorithm>
#include <cmath>
#include <utility>

// Hot loops are compiled for several instruction sets; the processor chooses at start.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define SIGMAFLOW_HOT __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define SIGMAFLOW_HOT
#endif

#define SIGMAFLOW_INLINE __attribute__((always_inline)) inline

namespace sigmaflow {

namespace {

constexpr int factor_lifetime = 10;  // solves; the factor hardly ages within so few steps
constexpr int most_iterations = 2000;

using v4 = double __attribute__((vector_size(32)));

SIGMAFLOW_INLINE v4 read(const double* p)
{
    return *reinterpret_cast<const v4*>(p);
}

SIGMAFLOW_INLINE void write(double* p, const v4& value)
{
    *reinterpret_cast<v4*>(p) = value;
}

SIGMAFLOW_INLINE v4 spread(double x)
{
    return v4{x, x, x, x};
}

SIGMAFLOW_INLINE double total(const v4& x)
{
    return (x[0] + x[2]) + (x[1] + x[3]);
}

/// One vector quantity of four particles.
struct Four {
    v4 x, y, z;
};

// (x, y, z, 0) of four particles from and to lanes
SIGMAFLOW_INLINE Four transposed(const double* a, const double* b, const double* c, const double* d)
{
    const v4 va = read(a), vb = read(b), vc = read(c), vd = read(d);
    const v4 xz_ab = __builtin_shufflevector(va, vb, 0, 4, 2, 6);
    const v4 y_ab = __builtin_shufflevector(va, vb, 1, 5, 3, 7);
    const v4 xz_cd = __builtin_shufflevector(vc, vd, 0, 4, 2, 6);
    const v4 y_cd = __builtin_shufflevector(vc, vd, 1, 5, 3, 7);
    return {__builtin_shufflevector(xz_ab, xz_cd, 0, 1, 4, 5),
            __builtin_shufflevector(y_ab, y_cd, 0, 1, 4, 5),
            __builtin_shufflevector(xz_ab, xz_cd, 2, 3, 6, 7)};
}

SIGMAFLOW_INLINE void subtract_transposed(const Four& f, double* a, double* b, double* c, double* d)
{
    const v4 zero = spread(0);
    const v4 xy_even = __builtin_shufflevector(f.x, f.y, 0, 4, 2, 6);
    const v4 xy_odd = __builtin_shufflevector(f.x, f.y, 1, 5, 3, 7);
    const v4 z_even = __builtin_shufflevector(f.z, zero, 0, 4, 2, 6);
    const v4 z_odd = __builtin_shufflevector(f.z, zero, 1, 5, 3, 7);
    write(a, read(a) - __builtin_shufflevector(xy_even, z_even, 0, 1, 4, 5));
    write(b, read(b) - __builtin_shufflevector(xy_odd, z_odd, 0, 1, 4, 5));
    write(c, read(c) - __builtin_shufflevector(xy_even, z_even, 2, 3, 6, 7));
    write(d, read(d) - __builtin_shufflevector(xy_odd, z_odd, 2, 3, 6, 7));
}

// (sum of the lanes of x, of y, of z, 0)
SIGMAFLOW_INLINE v4 lane_sums(const Four& f)
{
    const v4 zero = spread(0);
    const v4 xy_even = __builtin_shufflevector(f.x, f.y, 0, 4, 2, 6);
    const v4 xy_odd = __builtin_shufflevector(f.x, f.y, 1, 5, 3, 7);
    const v4 z_even = __builtin_shufflevector(f.z, zero, 0, 4, 2, 6);
    const v4 z_odd = __builtin_shufflevector(f.z, zero, 1, 5, 3, 7);
    const v4 xy = xy_even + xy_odd, z = z_even + z_odd;
    return __builtin_shufflevector(xy, z, 0, 1, 4, 5) + __builtin_shufflevector(xy, z, 2, 3, 6, 7);
}

/// y = A_i v
SIGMAFLOW_INLINE void diagonal_times(const DiagonalBlock& b, const double* v, double* y)
{
    const auto &t = b.translation, &r = b.rotation;
    const auto& c = b.coupling;
    y[0] = t[0] * v[0] + t[3] * v[1] + t[4] * v[2] + c[1] * v[6] - c[2] * v[5];
    y[1] = t[3] * v[0] + t[1] * v[1] + t[5] * v[2] + c[2] * v[4] - c[0] * v[6];
    y[2] = t[4] * v[0] + t[5] * v[1] + t[2] * v[2] + c[0] * v[5] - c[1] * v[4];
    y[3] = 0;
    y[4] = r[0] * v[4] + r[3] * v[5] + r[4] * v[6] - c[1] * v[2] + c[2] * v[1];
    y[5] = r[3] * v[4] + r[1] * v[5] + r[5] * v[6] - c[2] * v[0] + c[0] * v[2];
    y[6] = r[4] * v[4] + r[5] * v[5] + r[2] * v[6] - c[0] * v[1] + c[1] * v[0];
    y[7] = 0;
}

}

/// The loops over all particles of one solve; every vector has n + 1 particles, the last one zero.
struct ConjugateGradients::Sweep {
    int n;
    const PairGroup* groups;
    const int* first;
    const DiagonalBlock* diagonal;
    const Block* inverse;
    const Lanes* f;  // null: no rank-one term
    double weight;

    /// y = D_i^-1 v
    SIGMAFLOW_INLINE static void inverse_times(const Block& B, const double* v, double* y)
    {
        v4 upper = spread(0), lower = spread(0);
        for (int c = 0; c < 6; ++c) {
            const v4 value = spread(v[c < 3 ? c : c + 1]);
            upper += value * read(B.column[c].v);
            lower += value * read(B.column[c].v + 4);
        }
        write(y, upper);
        write(y + 4, lower);
    }

    /// load of the j -= L_ji v, v of i
    SIGMAFLOW_INLINE static void subtract_lower(const PairGroup& g, const double* v, Lanes* load)
    {
        const v4 nx = read(g.nx), ny = read(g.ny), nz = read(g.nz), ya = read(g.ya),
                 yc = read(g.yc);
        const v4 bi = read(g.yb_i), bj = read(g.yb_j);
        const v4 x = spread(v[0]), y = spread(v[1]), z = spread(v[2]);
        const v4 p = spread(v[4]), q = spread(v[5]), r = spread(v[6]);
        const v4 nu = read(g.ya_minus_xa) * (nx * x + ny * y + nz * z);
        const v4 nw = yc * (nx * p + ny * q + nz * r);
        const Four force{nu * nx - ya * x - bi * (ny * r - nz * q),
                         nu * ny - ya * y - bi * (nz * p - nx * r),
                         nu * nz - ya * z - bi * (nx * q - ny * p)};
        const Four torque{yc * p - nw * nx - bj * (ny * z - nz * y),
                          yc * q - nw * ny - bj * (nz * x - nx * z),
                          yc * r - nw * nz - bj * (nx * y - ny * x)};
        double *a = load[g.j[0]].v, *b = load[g.j[1]].v, *c = load[g.j[2]].v, *d = load[g.j[3]].v;
        subtract_transposed(force, a, b, c, d);
        subtract_transposed(torque, a + 4, b + 4, c + 4, d + 4);
    }

    /// load of i -= sum over the j of L_ji^T v_j, lane by lane
    SIGMAFLOW_INLINE static void subtract_upper(const PairGroup& g, const Lanes* v, Four& force,
                                                Four& torque)
    {
        const v4 nx = read(g.nx), ny = read(g.ny), nz = read(g.nz), ya = read(g.ya),
                 yc = read(g.yc);
        const v4 bi = read(g.yb_i), bj = read(g.yb_j);
        const double *a = v[g.j[0]].v, *b = v[g.j[1]].v, *c = v[g.j[2]].v, *d = v[g.j[3]].v;
        const Four u = transposed(a, b, c, d);
        const Four w = transposed(a + 4, b + 4, c + 4, d + 4);
        const v4 nu = read(g.ya_minus_xa) * (nx * u.x + ny * u.y + nz * u.z);
        const v4 nw = yc * (nx * w.x + ny * w.y + nz * w.z);
        force.x -= nu * nx - ya * u.x + bj * (ny * w.z - nz * w.y);
        force.y -= nu * ny - ya * u.y + bj * (nz * w.x - nx * w.z);
        force.z -= nu * nz - ya * u.z + bj * (nx * w.y - ny * w.x);
        torque.x -= yc * w.x - nw * nx + bi * (ny * u.z - nz * u.y);
        torque.y -= yc * w.y - nw * ny + bi * (nz * u.x - nx * u.z);
        torque.z -= yc * w.z - nw * nz + bi * (nx * u.y - ny * u.x);
    }

    /// own -= sum over the pairs of i of L_ji^T v_j
    SIGMAFLOW_INLINE void subtract_row(int i, const Lanes* v, double* own) const
    {
        const v4 zero = spread(0);
        Four force{zero, zero, zero}, torque{zero, zero, zero};
        for (int k = first[i]; k < first[i + 1]; ++k) subtract_upper(groups[k], v, force, torque);
        write(own, read(own) + lane_sums(force));
        write(own + 4, read(own + 4) + lane_sums(torque));
    }

    /// r = b - (K - w f f^T) x
    SIGMAFLOW_HOT void residual(const Lanes* b, const Lanes* x, Lanes* r) const
    {
        double fx = 0;
        if (f) fx = dot(f, x);
        for (int i = 0; i < n; ++i) {
            alignas(32) double y[8];
            diagonal_times(diagonal[i], x[i].v, y);
            for (int k = 0; k < 8; k += 4) {
                v4 value = read(b[i].v + k) - read(y + k);
                if (f) value += weight * fx * read(f[i].v + k);
                write(r[i].v + k, value);
            }
        }
        for (int i = 0; i < n; ++i) {
            subtract_row(i, x, r[i].v);
            for (int k = first[i]; k < first[i + 1]; ++k) subtract_lower(groups[k], x[i].v, r);
        }
    }

    /// y = (D + L)^-1 c; c is overwritten by D y.
    SIGMAFLOW_HOT void forward(Lanes* c, Lanes* y) const
    {
        for (int i = 0; i < n; ++i) {
            inverse_times(inverse[i], c[i].v, y[i].v);
            for (int k = first[i]; k < first[i + 1]; ++k) subtract_lower(groups[k], y[i].v, c);
        }
    }

    /// t = (D + L)^-T p, u = D t; returns f.t.
    SIGMAFLOW_HOT double backward(const Lanes* p, Lanes* u, Lanes* t) const
    {
        v4 ft = spread(0);
        for (int i = n - 1; i >= 0; --i) {
            write(u[i].v, read(p[i].v));
            write(u[i].v + 4, read(p[i].v + 4));
            subtract_row(i, t, u[i].v);
            inverse_times(inverse[i], u[i].v, t[i].v);
            if (f) ft += read(f[i].v) * read(t[i].v) + read(f[i].v + 4) * read(t[i].v + 4);
        }
        return total(ft);
    }

    /// q = t + (D + L)^-1 c, Dq = u + D (D + L)^-1 c, with c = p + (A_D - 2 D) t - w f (f.t);
    /// returns p.q.
    SIGMAFLOW_HOT double forward_of_product(const Lanes* p, const Lanes* t, const Lanes* u,
                                            double ft, Lanes* c, Lanes* q, Lanes* Dq) const
    {
        for (int i = 0; i < n; ++i) {
            alignas(32) double y[8];
            diagonal_times(diagonal[i], t[i].v, y);
            for (int k = 0; k < 8; k += 4) {
                v4 value = read(p[i].v + k) + read(y + k) - 2 * read(u[i].v + k);
                if (f) value -= weight * ft * read(f[i].v + k);
                write(c[i].v + k, value);
            }
        }
        v4 pq = spread(0);
        for (int i = 0; i < n; ++i) {
            alignas(32) double y[8];
            inverse_times(inverse[i], c[i].v, y);
            for (int k = first[i]; k < first[i + 1]; ++k) subtract_lower(groups[k], y, c);
            for (int k = 0; k < 8; k += 4) {
                const v4 value = read(t[i].v + k) + read(y + k);
                write(q[i].v + k, value);
                write(Dq[i].v + k, read(u[i].v + k) + read(c[i].v + k));
                pq += read(p[i].v + k) * value;
            }
        }
        return total(pq);
    }

    /// x += alpha t, r -= alpha q, z -= alpha Dq; returns r.z.
    SIGMAFLOW_HOT double update(double alpha, const Lanes* t, const Lanes* q, const Lanes* Dq,
                                Lanes* x, Lanes* r, Lanes* z) const
    {
        v4 rz = spread(0);
        for (int i = 0; i < n; ++i)
            for (int k = 0; k < 8; k += 4) {
                write(x[i].v + k, read(x[i].v + k) + alpha * read(t[i].v + k));
                const v4 new_r = read(r[i].v + k) - alpha * read(q[i].v + k);
                const v4 new_z = read(z[i].v + k) - alpha * read(Dq[i].v + k);
                write(r[i].v + k, new_r);
                write(z[i].v + k, new_z);
                rz += new_r * new_z;
            }
        return total(rz);
    }

    /// p = z + beta p
    SIGMAFLOW_HOT void turn(double beta, const Lanes* z, Lanes* p) const
    {
        for (int i = 0; i < n; ++i)
            for (int k = 0; k < 8; k += 4)
                write(p[i].v + k, read(z[i].v + k) + beta * read(p[i].v + k));
    }

    SIGMAFLOW_HOT double dot(const Lanes* v, const Lanes* w) const
    {
        v4 sum = spread(0);
        for (int i = 0; i < n; ++i)
            sum += read(v[i].v) * read(w[i].v) + read(v[i].v + 4) * read(w[i].v + 4);
        return total(sum);
    }
};

void ConjugateGradients::load(const ResistanceMatrix& m)
{
    n_ = m.size();
    first_.resize(n_ + 1);
    first_pair_.resize(n_ + 1);
    groups_.clear();
    std::size_t k = 0;
    for (int i = 0; i < n_; ++i) {
        first_[i] = static_cast<int>(groups_.size());
        first_pair_[i] = static_cast<int>(k);
        for (int lane = 0; k < m.pairs.size() && m.pairs[k].i == i; ++k, lane = (lane + 1) % 4) {
            const PairBlock& p = m.pairs[k];
            if (lane == 0) {
                groups_.push_back({});
                for (int& j : groups_.back().j) j = n_;
            }
            PairGroup& g = groups_.back();
            g.nx[lane] = p.normal.x();
            g.ny[lane] = p.normal.y();
            g.nz[lane] = p.normal.z();
            g.ya_minus_xa[lane] = p.ya - p.xa;
            g.ya[lane] = p.ya;
            g.yb_i[lane] = p.yb11;
            g.yb_j[lane] = p.yb21;
            g.yc[lane] = p.yc12;
            g.j[lane] = p.j;
        }
    }
    first_[n_] = static_cast<int>(groups_.size());
    first_pair_[n_] = static_cast<int>(k);
    diagonal_ = m.diagonal.data();
}

void ConjugateGradients::refresh_factor(const ResistanceMatrix& m)
{
    factor_.clear();
    for (const DiagonalBlock& b : m.diagonal) factor_.push_back(full(b));
    inverse_.resize(n_);
    for (int i = 0; i < n_; ++i) {
        Eigen::LLT<Mat6> llt(factor_[i]);
        if (llt.info() != Eigen::Success) llt.compute(full(m.diagonal[i]));
        const Mat6 solved = llt.solve(Mat6::Identity());
        const Mat6 inverse = 0.5 * (solved + solved.transpose());
        for (int c = 0; c < 6; ++c) {
            const auto column = inverse.col(c);
            inverse_[i].column[c] = {
                {column[0], column[1], column[2], 0, column[3], column[4], column[5], 0}};
        }
        for (int k = first_pair_[i]; k < first_pair_[i + 1]; ++k) {
            const Mat6 L = off_diagonal(m.pairs[k]).transpose();
            factor_[m.pairs[k].j].noalias() -= L * inverse * L.transpose();
        }
    }
}

bool ConjugateGradients::solve(const ResistanceProblem& problem, const Velocities& b, Velocities& x,
                               double tolerance, SolveReport& report)
{
    load(problem.matrix);
    if (age_ < 0 || age_ >= factor_lifetime || static_cast<int>(inverse_.size()) != n_) {
        refresh_factor(problem.matrix);
        age_ = 0;
    }
    ++age_;
    const std::size_t size = static_cast<std::size_t>(n_) + 1;
    work_.assign(11 * size, Lanes{});
    Lanes* next = work_.data();
    const auto vector = [&next, size] { return std::exchange(next, next + size); };
    Lanes *r = vector(), *z = vector(), *p = vector(), *t = vector(), *u = vector(), *q = vector(),
          *Dq = vector(), *c = vector(), *right = vector(), *solution = vector(), *f = vector();
    const auto spread_out = [](const Velocities& from, Lanes* to) {
        for (std::size_t i = 0; i < from.size(); ++i)
            to[i] = {
                {from[i][0], from[i][1], from[i][2], 0, from[i][3], from[i][4], from[i][5], 0}};
    };
    spread_out(b, right);
    spread_out(x, solution);
    if (problem.direction) spread_out(*problem.direction, f);
    const Sweep sweep{n_,
                      groups_.data(),
                      first_.data(),
                      diagonal_,
                      inverse_.data(),
                      problem.direction ? f : nullptr,
                      problem.weight};

    // size of the right-hand side in the norm of the preconditioner
    std::copy(right, right + size, c);
    sweep.forward(c, r);
    const double goal = tolerance * tolerance * sweep.dot(r, c);

    sweep.residual(right, solution, z);
    sweep.forward(z, r);  // z = D r
    double rho = sweep.dot(r, z);
    std::copy(z, z + size, p);
    report.iterations = 0;
    while (rho > goal) {
        if (report.iterations == most_iterations || !std::isfinite(rho)) return false;
        const double ft = sweep.backward(p, u, t);
        const double curvature = sweep.forward_of_product(p, t, u, ft, c, q, Dq);
        if (!(curvature > 0)) return false;
        const double next_rho = sweep.update(rho / curvature, t, q, Dq, solution, r, z);
        sweep.turn(next_rho / rho, z, p);
        rho = next_rho;
        ++report.iterations;
    }
    sweep.residual(right, solution, z);
    const double b2 = sweep.dot(right, right);
    report.residual = b2 > 0 ? std::sqrt(sweep.dot(z, z) / b2) : 0;
    for (std::size_t i = 0; i < x.size(); ++i)
        x[i] << solution[i].v[0], solution[i].v[1], solution[i].v[2], solution[i].v[4],
            solution[i].v[5], solution[i].v[6];
    return true;
}

}
