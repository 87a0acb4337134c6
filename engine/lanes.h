// engine/lanes.h -- vectors of eight lanes for the hot loops, whatever the processor has.
//
// Compiler vectors: on processors with narrower registers the compiler splits them. Functions
// marked SIGMAFLOW_HOT are compiled for several instruction sets and chosen when the program
// starts; everything they call must be SIGMAFLOW_INLINE. The macro SIGMAFLOW_LEVELS, for
// measurements, replaces the list of instruction sets.
#pragma once
#include <cstddef>
#include <type_traits>

#ifndef SIGMAFLOW_LEVELS
#define SIGMAFLOW_LEVELS "arch=x86-64-v4", "arch=x86-64-v3", "default"
#endif
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SIGMAFLOW_HOT __attribute__((target_clones(SIGMAFLOW_LEVELS)))
#else
#define SIGMAFLOW_HOT
#endif
#define SIGMAFLOW_INLINE __attribute__((always_inline)) inline

namespace sigmaflow {

inline constexpr int lanes = 8;

using f8 = float __attribute__((vector_size(32)));
using d8 = double __attribute__((vector_size(64)));

template <class V>
using Scalar = std::remove_cvref_t<decltype(V{}[0])>;

/// Eight lanes as elements of containers, aligned.
template <class V>
struct alignas(64) Lanes {
    V v;
};
using D8 = Lanes<d8>;

template <class V>
SIGMAFLOW_INLINE V spread(double x)
{
    return V{} + static_cast<Scalar<V>>(x);
}

/// Eight doubles as V, eight of V as doubles.
template <class V>
SIGMAFLOW_INLINE V narrowed(const d8& x)
{
    return __builtin_convertvector(x, V);
}

template <class V>
SIGMAFLOW_INLINE d8 widened(const V& x)
{
    return __builtin_convertvector(x, d8);
}

/// The sum of all lanes, always in the same order.
SIGMAFLOW_INLINE double total(const d8& x)
{
    return ((x[0] + x[4]) + (x[1] + x[5])) + ((x[2] + x[6]) + (x[3] + x[7]));
}

template <class V>
SIGMAFLOW_INLINE V larger(const V& a, const V& b)
{
    return a > b ? a : b;
}

SIGMAFLOW_INLINE d8 square_root(const d8& x)
{
    d8 r;
    for (int l = 0; l < lanes; ++l) r[l] = __builtin_sqrt(x[l]);
    return r;
}

/// One vector quantity of eight particles or pairs.
template <class V>
struct Triple {
    V x, y, z;
};

template <class V>
SIGMAFLOW_INLINE Triple<V> operator+(const Triple<V>& a, const Triple<V>& b)
{
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}

template <class V>
SIGMAFLOW_INLINE Triple<V> operator-(const Triple<V>& a, const Triple<V>& b)
{
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}

template <class V>
SIGMAFLOW_INLINE Triple<V> operator*(const V& s, const Triple<V>& a)
{
    return {s * a.x, s * a.y, s * a.z};
}

template <class V>
SIGMAFLOW_INLINE V dot(const Triple<V>& a, const Triple<V>& b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class V>
SIGMAFLOW_INLINE Triple<V> cross(const Triple<V>& a, const Triple<V>& b)
{
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Rows of eight numbers (x y z 0, x y z 0) of eight particles from and to lanes.
template <class V>
SIGMAFLOW_INLINE void gather_rows(const V* row, const int* index, Triple<V>& u, Triple<V>& w)
{
    const V a = row[index[0]], b = row[index[1]], c = row[index[2]], d = row[index[3]];
    const V e = row[index[4]], f = row[index[5]], g = row[index[6]], h = row[index[7]];
    const V ab01 = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
    const V ab2 = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
    const V cd01 = __builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13);
    const V cd2 = __builtin_shufflevector(c, d, 2, 10, 3, 11, 6, 14, 7, 15);
    const V ef01 = __builtin_shufflevector(e, f, 0, 8, 1, 9, 4, 12, 5, 13);
    const V ef2 = __builtin_shufflevector(e, f, 2, 10, 3, 11, 6, 14, 7, 15);
    const V gh01 = __builtin_shufflevector(g, h, 0, 8, 1, 9, 4, 12, 5, 13);
    const V gh2 = __builtin_shufflevector(g, h, 2, 10, 3, 11, 6, 14, 7, 15);
    const V x_abcd = __builtin_shufflevector(ab01, cd01, 0, 1, 8, 9, 4, 5, 12, 13);
    const V y_abcd = __builtin_shufflevector(ab01, cd01, 2, 3, 10, 11, 6, 7, 14, 15);
    const V z_abcd = __builtin_shufflevector(ab2, cd2, 0, 1, 8, 9, 4, 5, 12, 13);
    const V x_efgh = __builtin_shufflevector(ef01, gh01, 0, 1, 8, 9, 4, 5, 12, 13);
    const V y_efgh = __builtin_shufflevector(ef01, gh01, 2, 3, 10, 11, 6, 7, 14, 15);
    const V z_efgh = __builtin_shufflevector(ef2, gh2, 0, 1, 8, 9, 4, 5, 12, 13);
    u.x = __builtin_shufflevector(x_abcd, x_efgh, 0, 1, 2, 3, 8, 9, 10, 11);
    u.y = __builtin_shufflevector(y_abcd, y_efgh, 0, 1, 2, 3, 8, 9, 10, 11);
    u.z = __builtin_shufflevector(z_abcd, z_efgh, 0, 1, 2, 3, 8, 9, 10, 11);
    w.x = __builtin_shufflevector(x_abcd, x_efgh, 4, 5, 6, 7, 12, 13, 14, 15);
    w.y = __builtin_shufflevector(y_abcd, y_efgh, 4, 5, 6, 7, 12, 13, 14, 15);
    w.z = __builtin_shufflevector(z_abcd, z_efgh, 4, 5, 6, 7, 12, 13, 14, 15);
}

template <class V>
SIGMAFLOW_INLINE void write_four_rows(const V& x, const V& y, const V& z, V* row)
{
    const V zero{};
    const V xy01 = __builtin_shufflevector(x, y, 0, 8, 1, 9, 4, 12, 5, 13);
    const V xy23 = __builtin_shufflevector(x, y, 2, 10, 3, 11, 6, 14, 7, 15);
    const V z01 = __builtin_shufflevector(z, zero, 0, 8, 1, 9, 4, 12, 5, 13);
    const V z23 = __builtin_shufflevector(z, zero, 2, 10, 3, 11, 6, 14, 7, 15);
    row[0] = __builtin_shufflevector(xy01, z01, 0, 1, 8, 9, 4, 5, 12, 13);
    row[1] = __builtin_shufflevector(xy01, z01, 2, 3, 10, 11, 6, 7, 14, 15);
    row[2] = __builtin_shufflevector(xy23, z23, 0, 1, 8, 9, 4, 5, 12, 13);
    row[3] = __builtin_shufflevector(xy23, z23, 2, 3, 10, 11, 6, 7, 14, 15);
}

template <class V>
SIGMAFLOW_INLINE void write_rows(const Triple<V>& u, const Triple<V>& w, V* rows)
{
    write_four_rows(__builtin_shufflevector(u.x, w.x, 0, 1, 2, 3, 8, 9, 10, 11),
                    __builtin_shufflevector(u.y, w.y, 0, 1, 2, 3, 8, 9, 10, 11),
                    __builtin_shufflevector(u.z, w.z, 0, 1, 2, 3, 8, 9, 10, 11), rows);
    write_four_rows(__builtin_shufflevector(u.x, w.x, 4, 5, 6, 7, 12, 13, 14, 15),
                    __builtin_shufflevector(u.y, w.y, 4, 5, 6, 7, 12, 13, 14, 15),
                    __builtin_shufflevector(u.z, w.z, 4, 5, 6, 7, 12, 13, 14, 15), rows + 4);
}

/// Three neighbouring values of rows of `Width` doubles of eight particles.
template <int Width, int First = 0>
SIGMAFLOW_INLINE Triple<d8> gather_triple(const double* rows, const int* index)
{
    Triple<d8> t;
    for (int l = 0; l < lanes; ++l) {
        const double* row = rows + static_cast<std::size_t>(Width) * index[l] + First;
        t.x[l] = row[0];
        t.y[l] = row[1];
        t.z[l] = row[2];
    }
    return t;
}

/// One member of eight elements that may lie anywhere, lane by lane, in groups of d8 members.
template <class Group>
SIGMAFLOW_INLINE d8 pick(const Group* groups, const int* pair, int member)
{
    d8 v;
    for (int l = 0; l < lanes; ++l)
        v[l] = reinterpret_cast<const double*>(groups +
                                               pair[l] / lanes)[member * lanes + pair[l] % lanes];
    return v;
}

}
