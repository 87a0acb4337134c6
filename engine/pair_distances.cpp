#include "engine/pair_distances.h"

#include "engine/lanes.h"

namespace sigmaflow {

namespace {

struct Points {
    const double *x, *y, *z;
};

struct Separations {
    double *x, *y, *z, *square;
};

SIGMAFLOW_INLINE double whole(double x)
{
    constexpr double magic = 0x1.8p52;  // as nearest_integer, inlined into every clone
    return (x + magic) - magic;
}

SIGMAFLOW_HOT void separations(const Box& box, const Points& from, int i, int n,
                               const Separations& to)
{
    const double lx = box.length.x(), ly = box.length.y(), lz = box.length.z();
    const double ix = 1 / lx, iy = 1 / ly, iz = 1 / lz, offset = box.offset;
    const double *x = from.x, *y = from.y, *z = from.z;
    double* __restrict out_x = to.x, * __restrict out_y = to.y, * __restrict out_z = to.z;
    double* __restrict square = to.square;
    const double own_x = x[i], own_y = y[i], own_z = z[i];
    for (int j = i + 1; j < n; ++j) {
        double dx = x[j] - own_x, dy = y[j] - own_y, dz = z[j] - own_z;
        const double q = whole(dy * iy);
        dy -= q * ly;
        dx -= q * offset;
        dx -= lx * whole(dx * ix);
        dz -= lz * whole(dz * iz);
        out_x[j] = dx;
        out_y[j] = dy;
        out_z[j] = dz;
        square[j] = dx * dx + dy * dy + dz * dz;
    }
}

}

PairDistances::PairDistances(const State& state) : box_(state.box), n_(state.size())
{
    for (const Vec3& p : state.position) {
        x_.push_back(p.x());
        y_.push_back(p.y());
        z_.push_back(p.z());
    }
    for (auto* list : {&dx_, &dy_, &dz_, &r2_}) list->resize(x_.size());
}

void PairDistances::find_from(int i)
{
    separations(box_, {x_.data(), y_.data(), z_.data()}, i, n_,
                {dx_.data(), dy_.data(), dz_.data(), r2_.data()});
}

}
