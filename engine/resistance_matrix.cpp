#include "engine/resistance_matrix.h"

namespace sigmaflow {

Mat6 off_diagonal(const PairBlock& p)
{
    const Mat3 nn = p.normal * p.normal.transpose();
    const Mat3 tangential = Mat3::Identity() - nn;
    const Mat3 twist = cross_matrix(p.normal);
    Mat6 block;
    block.topLeftCorner<3, 3>() = -(p.xa * nn + p.ya * tangential);
    block.topRightCorner<3, 3>() = p.yb21 * twist;
    block.bottomLeftCorner<3, 3>() = p.yb11 * twist;
    block.bottomRightCorner<3, 3>() = p.yc12 * tangential;
    return block;
}

Mat6 full(const DiagonalBlock& b)
{
    const auto symmetric = [](const std::array<double, 6>& v) {
        Mat3 m;
        m << v[0], v[3], v[4], v[3], v[1], v[5], v[4], v[5], v[2];
        return m;
    };
    const Mat3 coupling = cross_matrix(Vec3(b.coupling.data()));
    Mat6 m;
    m << symmetric(b.translation), coupling, -coupling, symmetric(b.rotation);
    return m;
}

void multiply(const ResistanceMatrix& m, const Velocities& v, Velocities& result)
{
    result.resize(v.size());
    for (int i = 0; i < m.size(); ++i) result[i].noalias() = full(m.diagonal[i]) * v[i];
    for (const PairBlock& p : m.pairs) {
        result[p.i] += times(p, v[p.j]);
        result[p.j] += transposed_times(p, v[p.i]);
    }
}

double dot(const Velocities& u, const Velocities& v)
{
    double sum = 0;
    for (std::size_t i = 0; i < u.size(); ++i) sum += u[i].dot(v[i]);
    return sum;
}

}
