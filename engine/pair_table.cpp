#include "engine/pair_table.h"

#include "engine/lean_resize.h"
#include "engine/lubrication/pair_resistance.h"

#include <array>
#include <cmath>

// The vector versions of glibc (libmvec), which are accurate to 4 units in the last place.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && defined(__GLIBC__)
extern "C" {
extern double log(double) noexcept __attribute__((__simd__("notinbranch")));
extern double exp(double) noexcept __attribute__((__simd__("notinbranch")));
}
#endif

namespace sigmaflow {

namespace {

SIGMAFLOW_INLINE double* array(d8& v)
{
    return reinterpret_cast<double*>(&v);
}

SIGMAFLOW_INLINE d8 nearest_integers(const d8& x)
{
    const d8 magic = spread<d8>(0x1.8p52);
    return (x + magic) - magic;
}

template <class Group>
SIGMAFLOW_INLINE Triple<d8> pick_triple(const Group* groups, const int* pair, int member)
{
    return {pick(groups, pair, member), pick(groups, pair, member + 1),
            pick(groups, pair, member + 2)};
}

SIGMAFLOW_INLINE Triple<d8> normal_of(const PairGeometry& g)
{
    return {g.nx, g.ny, g.nz};
}

}

namespace {

/// The resistance scalars of pairs of radii: there are few different ones, the last are remembered.
class KnownCoefficients {
public:
    const lubrication::PairResistance& of(double a, double b)
    {
        for (const Known& k : known_)
            if (k.a == a && k.b == b) return k.c;
        Known& k = known_[oldest_++ % known_.size()];
        k = {a, b, lubrication::pair_coefficients(a, b)};
        return k.c;
    }

private:
    struct Known {
        double a = 0, b = 0;
        lubrication::PairResistance c;
    };
    std::array<Known, 4> known_;
    std::size_t oldest_ = 0;
};

PairShape shape_of(const State& state, const Slices& s, int group, KnownCoefficients& known)
{
    PairShape shape{};
    for (int l = 0; l < lanes; ++l) {
        const int pair = group * lanes + l;
        shape.sum[l] = 1;
        if (s.second[pair] == s.slots()) continue;
        const double a = state.radius[s.particle[s.first[pair]]];
        const double b = state.radius[s.particle[s.second[pair]]];
        const lubrication::PairResistance& c = known.of(a, b);
        shape.a[l] = a;
        shape.b[l] = b;
        shape.sum[l] = a + b;
        shape.xa[l] = c.xa;
        shape.ya[l] = c.ya;
        shape.yb11[l] = c.yb11;
        shape.yb21[l] = c.yb21;
        shape.yc11[l] = c.yc11;
        shape.yc12[l] = c.yc12;
        shape.yc22[l] = c.yc22;
    }
    return shape;
}

}

void make_shapes(const State& state, const Slices& s, int threads, PairTable& table)
{
    const std::size_t count = s.groups() + 1;
    lean_resize(table.shape, count);
    lean_resize(table.geometry, count);
    lean_resize(table.factors, count);
    lean_resize(table.force, count);
    lean_resize(table.springs, count);
    table.shape.back() = PairShape{};
    table.geometry.back() = PairGeometry{};
    table.factors.back() = PairFactors{};
    table.force.back() = PairForce{};
    table.springs.back() = PairSprings{};
    with_team(threads, [&](const Team& team) {
        KnownCoefficients known;
        team.own(s, [&](Range own) {
            for (int g = s.upper[own.begin]; g < s.upper[own.end]; ++g)
                table.shape[g] = shape_of(state, s, g, known);
        });
    });
}

void write_positions(const State& state, const Slices& s, Range range, double* rows)
{
    for (int slot = range.begin * lanes; slot < range.end * lanes; ++slot) {
        const int i = s.particle[slot];
        for (int c = 0; c < 3; ++c) rows[4 * slot + c] = i < 0 ? 0 : state.position[i][c];
    }
}

SIGMAFLOW_HOT bool find_geometry(const Slices& s, const Box& box, const double* rows, Range range,
                                 PairTable& table)
{
    const d8 Lx = spread<d8>(box.length.x()), Ly = spread<d8>(box.length.y()),
             Lz = spread<d8>(box.length.z());
    const d8 ix = spread<d8>(1 / box.length.x()), iy = spread<d8>(1 / box.length.y()),
             iz = spread<d8>(1 / box.length.z());
    const d8 tiny = spread<d8>(1e-200);
    d8 bad{};
    for (int k = range.begin; k < range.end; ++k)
        for (int g = s.upper[k]; g < s.upper[k + 1]; ++g) {
            const Triple<d8> from = gather_triple<4>(rows, s.first.data() + g * lanes);
            Triple<d8> d = gather_triple<4>(rows, s.second.data() + g * lanes) - from;
            const d8 q = -nearest_integers(d.y * iy);
            d.y += q * Ly;
            d.x += q * box.offset;
            d.x -= Lx * nearest_integers(d.x * ix);
            d.z -= Lz * nearest_integers(d.z * iz);
            const d8 r2 = dot(d, d);
            bad += r2 > tiny ? d8{} : spread<d8>(1);  // also if not a number
            const d8 r = square_root(larger(r2, tiny)), inverse = 1 / r;
            const d8 sum = table.shape[g].sum;
            PairGeometry& out = table.geometry[g];
            out = {inverse * d.x, inverse * d.y, inverse * d.z, r, 2 * (r - sum) / sum, q};
        }
    return total(bad) == 0;
}

SIGMAFLOW_HOT void find_factors(const Slices& s, const Model& m, const Stiffness& k, Range range,
                                PairTable& table, D8* moment)
{
    const double size = reference_force * m.repulsion;
    const bool by_radius = m.repulsion_amplitude != RepulsionAmplitude::constant;
    const double per_radius =
        by_radius ? (m.repulsion_amplitude == RepulsionAmplitude::derjaguin ? 2 : 1) * size : 0;
    const double constant = by_radius ? 0 : size;
    const bool relaxation = m.contact_relaxation_time > 0;
    const d8 touching_L = spread<d8>(4 * k.normal * m.contact_relaxation_time);
    const d8 zero{}, one = spread<d8>(1);
    const d8 inverse_length = spread<d8>(-1 / m.debye_length);
    for (int slice = range.begin; slice < range.end; ++slice) {
        d8 sum{};
        for (int g = s.upper[slice]; g < s.upper[slice + 1]; ++g) {
            const PairGeometry& geometry = table.geometry[g];
            const PairShape& shape = table.shape[g];
            PairFactors& f = table.factors[g];
            const d8 open = larger(geometry.xi, zero);
            const d8 L = 1 / (open + m.lubrication_delta);
            d8 argument = larger(L, one), exponent = 0.5 * shape.sum * open * inverse_length;
            d8 logarithm, decay;
            double *in = array(argument), *out = array(logarithm);
#pragma omp simd
            for (int l = 0; l < lanes; ++l) out[l] = log(in[l]);
            in = array(exponent);
            out = array(decay);
#pragma omp simd
            for (int l = 0; l < lanes; ++l) out[l] = exp(in[l]);
            const auto in_range = geometry.xi < m.lubrication_range;
            const d8 closed = relaxation ? touching_L : L;
            f.L = in_range ? (geometry.xi > 0 ? L : closed) : zero;
            f.l = in_range ? logarithm : zero;
            const d8 amplitude = constant + per_radius * shape.a * shape.b / shape.sum;
            f.repulsion = geometry.xi < m.repulsion_range ? amplitude * decay : zero;
            PairForce& force = table.force[g];
            const Triple<d8> nothing{zero, zero, zero};
            force = {-f.repulsion * normal_of(geometry), nothing, nothing};
            sum -= f.repulsion * geometry.distance * geometry.nx * geometry.ny;
        }
        moment[slice].v = sum;
    }
}

void find_repulsion_springs(const Slices& s, const Model& m, double ahead, Range range,
                            PairTable& table)
{
    const d8 zero{};
    for (int g = s.upper[range.begin]; g < s.upper[range.end]; ++g)
        table.springs[g] = {
            table.geometry[g].xi > 0 ? ahead / m.debye_length * table.factors[g].repulsion : zero,
            zero, zero};
}

SIGMAFLOW_HOT void add_predicted_motion(const Slices& s, const double* rows, double rate,
                                        Range range, PairTable& table, D8* moment)
{
    for (int slice = range.begin; slice < range.end; ++slice) {
        d8 sum{};
        for (int g = s.upper[slice]; g < s.upper[slice + 1]; ++g) {
            const int *first = s.first.data() + g * lanes, *second = s.second.data() + g * lanes;
            const PairShape& shape = table.shape[g];
            const PairSprings& spring = table.springs[g];
            const Triple<d8> n = normal_of(table.geometry[g]);
            const Triple<d8> wi = gather_triple<8, 4>(rows, first);
            const Triple<d8> wj = gather_triple<8, 4>(rows, second);
            // relative motion of the surfaces, less that of the affine flow
            Triple<d8> du = gather_triple<8>(rows, first) - gather_triple<8>(rows, second);
            const Triple<d8> e{0.5 * n.y, 0.5 * n.x, d8{}};
            du = du - rate * shape.sum * e;
            const d8 along = dot(n, du);
            const Triple<d8> slip = du - along * n - cross(n, shape.a * wi + shape.b * wj);
            const Triple<d8> friction = spring.shear * slip;
            const Triple<d8> force = spring.normal * along * n + friction;
            const Triple<d8> turning = wi - wj;
            PairForce& out = table.force[g];
            out.force = out.force + force;
            out.lever = out.lever + cross(n, friction);
            out.roll = out.roll + spring.roll * (turning - dot(n, turning) * n);
            sum += shape.sum * dot(e, force);
        }
        moment[slice].v += sum;
    }
}

SIGMAFLOW_HOT void fill_matrix(const Slices& s, const PairTable& table, bool with_springs,
                               Range range, ResistanceMatrix& matrix)
{
    for (int g = s.upper[range.begin]; g < s.upper[range.end]; ++g) {
        const PairShape& c = table.shape[g];
        const PairFactors& f = table.factors[g];
        const PairGeometry& n = table.geometry[g];
        PairGroup p{n.nx,         n.ny,         n.nz,         f.L * c.xa,   f.l * c.ya,
                    f.l * c.yb11, f.l * c.yb21, f.l * c.yc11, f.l * c.yc12, f.l * c.yc22};
        if (with_springs) {
            const PairSprings& spring = table.springs[g];
            p.xa += spring.normal;
            p.ya += spring.shear;
            p.yb11 -= c.a * spring.shear;
            p.yb21 -= c.b * spring.shear;
            p.yc11 += c.a * c.a * spring.shear + spring.roll;
            p.yc12 += c.a * c.b * spring.shear - spring.roll;
            p.yc22 += c.b * c.b * spring.shear + spring.roll;
        }
        matrix.pairs[g] = p;
    }
}

// An affine flow acts only through the relative velocity r n.grad U, so that the sums over the
// resistance functions G, H, M that stress control needs are multiples of A and B (identities of
// the functions of Jeffrey & Onishi and Jeffrey, tested): Ehat:R_SE:Ehat = s^2 XA (n.e)^2 + s^2 YA
// (e.e - (n.e)^2), load s XA (n.e) n + s YA (e - (n.e) n), s YB e x n.
SIGMAFLOW_HOT void sum_loads(const Slices& s, const PairTable& table, const ResistanceMatrix& m,
                             bool touching_drive, Range range, const LoadSums& sums)
{
    const d8 zero{};
    for (int k = range.begin; k < range.end; ++k) {
        Triple<d8> F{}, T{}, G{}, H{};  // per unit rate, of the forces
        d8 affine{};
        for (int g = s.upper[k]; g < s.upper[k + 1]; ++g) {
            const PairShape& shape = table.shape[g];
            const PairGroup& p = m.pairs[g];
            const PairForce& f = table.force[g];
            const Triple<d8> n{p.nx, p.ny, p.nz}, e{0.5 * n.y, 0.5 * n.x, zero};
            const d8 drive = touching_drive             ? shape.sum
                             : table.geometry[g].xi > 0 ? shape.sum
                                                        : zero;
            const d8 along = n.x * n.y;
            const Triple<d8> across = e - along * n;
            F = F + drive * (p.xa * along * n + p.ya * across);
            T = T + drive * p.yb11 * cross(e, n);
            affine += drive * shape.sum * (p.xa * along * along + p.ya * dot(across, across));
            G = G + f.force;
            H = H + shape.a * f.lever + f.roll;
        }
        for (int g = s.lower[k]; g < s.lower[k + 1]; ++g) {
            const int* pair = s.lower_pair.data() + g * lanes;
            const Triple<d8> n = pick_triple(m.pairs.data(), pair, 0);
            const d8 xa = pick(m.pairs.data(), pair, 3), ya = pick(m.pairs.data(), pair, 4),
                     yb21 = pick(m.pairs.data(), pair, 6);
            const d8 b = pick(table.shape.data(), pair, 1), sum = pick(table.shape.data(), pair, 2);
            const d8 drive = touching_drive                             ? sum
                             : pick(table.geometry.data(), pair, 4) > 0 ? sum
                                                                        : zero;
            const Triple<d8> e{0.5 * n.y, 0.5 * n.x, zero};
            const d8 along = n.x * n.y;
            F = F - drive * (xa * along * n + ya * (e - along * n));
            T = T + drive * yb21 * cross(e, n);
            G = G - pick_triple(table.force.data(), pair, 0);
            H = H + b * pick_triple(table.force.data(), pair, 3) -
                pick_triple(table.force.data(), pair, 6);
        }
        sums.unit[k] = {{F.x, F.y, F.z, T.x, T.y, T.z}};
        sums.fixed[k] = {{G.x, G.y, G.z, H.x, H.y, H.z}};
        sums.affine[k].v = affine;
    }
}

}
