#include "engine/resistance_matrix.h"

namespace sigmaflow {

namespace {

/// Eight pairs as one of their particles sees them: the normal points to the other one.
struct OwnGroup {
    Triple<d8> n;
    d8 xa, ya, yb_own, yb_other, yc_own, yc_cross;
};

SIGMAFLOW_INLINE OwnGroup seen_by_first(const PairGroup& g)
{
    return {{g.nx, g.ny, g.nz}, g.xa, g.ya, g.yb11, g.yb21, g.yc11, g.yc12};
}

SIGMAFLOW_INLINE OwnGroup seen_by_second(const PairGroup* groups, const int* pair)
{
    const auto member = [&](int k) { return pick(groups, pair, k); };
    return {{-member(0), -member(1), -member(2)},
            member(3),
            member(4),
            member(6),
            member(5),
            member(9),
            member(8)};
}

struct Motion {
    Triple<d8> u, w;
};

// load -= R_pair V of the own particle; in relative velocities, so that a rigid motion gives
// exactly nothing
SIGMAFLOW_INLINE void subtract_pair(const OwnGroup& o, const Motion& own, const Motion& other,
                                    Motion& load)
{
    const Triple<d8> du = own.u - other.u;
    const Triple<d8> normal = dot(o.n, du) * o.n;
    const Triple<d8> force =
        o.xa * normal + o.ya * (du - normal) + cross(o.n, o.yb_own * own.w + o.yb_other * other.w);
    const Triple<d8> turn = o.yc_own * own.w + o.yc_cross * other.w;
    const Triple<d8> torque = turn - dot(o.n, turn) * o.n - o.yb_own * cross(o.n, du);
    load.u = load.u - force;
    load.w = load.w - torque;
}

SIGMAFLOW_INLINE Motion motion_of(const Slice6& s)
{
    return {{s.c[0], s.c[1], s.c[2]}, {s.c[3], s.c[4], s.c[5]}};
}

SIGMAFLOW_INLINE Motion gather_motion(const double* rows, const int* slot)
{
    return {gather_triple<8>(rows, slot), gather_triple<8, 4>(rows, slot)};
}

SIGMAFLOW_INLINE void add_block(const OwnGroup& o, DiagonalSlice<d8>& b)
{
    const d8 products[6] = {o.n.x * o.n.x, o.n.y * o.n.y, o.n.z * o.n.z,
                            o.n.x * o.n.y, o.n.x * o.n.z, o.n.y * o.n.z};
    const d8 difference = o.xa - o.ya;
    for (int k = 0; k < 6; ++k) {
        b.translation[k] += difference * products[k];
        b.rotation[k] -= o.yc_own * products[k];
    }
    for (int k = 0; k < 3; ++k) {
        b.translation[k] += o.ya;
        b.rotation[k] += o.yc_own;
    }
    b.coupling[0] += o.yb_own * o.n.x;
    b.coupling[1] += o.yb_own * o.n.y;
    b.coupling[2] += o.yb_own * o.n.z;
}

}

SIGMAFLOW_HOT void subtract_product(const ResistanceMatrix& m, const SlicedVector& v,
                                    const double* rows, const SlicedVector& b, Range range,
                                    SlicedVector& r)
{
    const Slices& s = *m.slices;
    const PairGroup* pairs = m.pairs.data();
    for (int k = range.begin; k < range.end; ++k) {
        const Motion own = motion_of(v[k]);
        Motion load = motion_of(b[k]);
        load.u = load.u - m.drag[2 * k].v * own.u;
        load.w = load.w - m.drag[2 * k + 1].v * own.w;
        for (int g = s.upper[k]; g < s.upper[k + 1]; ++g)
            subtract_pair(seen_by_first(pairs[g]), own,
                          gather_motion(rows, s.second.data() + g * lanes), load);
        for (int g = s.lower[k]; g < s.lower[k + 1]; ++g)
            subtract_pair(seen_by_second(pairs, s.lower_pair.data() + g * lanes), own,
                          gather_motion(rows, s.lower_slot.data() + g * lanes), load);
        r[k] = {{load.u.x, load.u.y, load.u.z, load.w.x, load.w.y, load.w.z}};
    }
}

void write_rows(const SlicedVector& v, Range range, double* rows)
{
    for (int k = range.begin; k < range.end; ++k)
        for (int l = 0; l < lanes; ++l) {
            double* row = rows + static_cast<std::size_t>(8) * (k * lanes + l);
            for (int c = 0; c < 3; ++c) {
                row[c] = v[k].c[c][l];
                row[4 + c] = v[k].c[3 + c][l];
            }
        }
}

void multiply(const ResistanceMatrix& m, const SlicedVector& v, SlicedVector& result)
{
    const int count = m.slices->count;
    std::vector<double> rows(static_cast<std::size_t>(8) * (count + 1) * lanes, 0.);
    write_rows(v, {0, count}, rows.data());
    const SlicedVector zero(count + 1);
    result.resize(count + 1);
    result.back() = Slice6{};  // may hold values from a time with more slices
    subtract_product(m, v, rows.data(), zero, {0, count}, result);
    for (Slice6& slice : result)
        for (d8& c : slice.c) c = -c;
}

SIGMAFLOW_HOT void diagonal_blocks(const ResistanceMatrix& m, Range range,
                                   DiagonalSlice<d8>* blocks)
{
    const Slices& s = *m.slices;
    for (int k = range.begin; k < range.end; ++k) {
        DiagonalSlice<d8> b{};
        for (int c = 0; c < 3; ++c) {
            b.translation[c] = m.drag[2 * k].v;
            b.rotation[c] = m.drag[2 * k + 1].v;
        }
        for (int g = s.upper[k]; g < s.upper[k + 1]; ++g) add_block(seen_by_first(m.pairs[g]), b);
        for (int g = s.lower[k]; g < s.lower[k + 1]; ++g)
            add_block(seen_by_second(m.pairs.data(), s.lower_pair.data() + g * lanes), b);
        blocks[k] = b;
    }
}

Mat6 diagonal_block(const DiagonalSlice<d8>* blocks, int slot)
{
    const DiagonalSlice<d8>& b = blocks[slot / lanes];
    const int l = slot % lanes;
    const auto symmetric = [l](const d8* v) {
        Mat3 m;
        m << v[0][l], v[3][l], v[4][l], v[3][l], v[1][l], v[5][l], v[4][l], v[5][l], v[2][l];
        return m;
    };
    const Mat3 coupling = cross_matrix(Vec3(b.coupling[0][l], b.coupling[1][l], b.coupling[2][l]));
    Mat6 m;
    m << symmetric(b.translation), coupling, -coupling, symmetric(b.rotation);
    return m;
}

Mat6 off_diagonal_block(const ResistanceMatrix& m, int pair)
{
    const PairGroup& g = m.pairs[pair / lanes];
    const int l = pair % lanes;
    const Vec3 n(g.nx[l], g.ny[l], g.nz[l]);
    const Mat3 nn = n * n.transpose(), tangential = Mat3::Identity() - nn;
    const Mat3 twist = cross_matrix(n);
    Mat6 block;
    block << -(g.xa[l] * nn + g.ya[l] * tangential), g.yb21[l] * twist, g.yb11[l] * twist,
        g.yc12[l] * tangential;
    return block;
}

}
