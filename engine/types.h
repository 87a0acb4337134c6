// engine/types.h -- small fixed-size algebra and the axes used everywhere.
//
// Axes: 0 = x = flow, 1 = y = gradient, 2 = z = vorticity (right-handed).
// Tensors are symmetric 3x3, tension positive.
#pragma once
#include <Eigen/Dense>

namespace sigmaflow {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

enum Axis { flow = 0, gradient = 1, vorticity = 2 };

/// Matrix of v -> n x v.
inline Mat3 cross_matrix(const Vec3& n)
{
    Mat3 m;
    m << 0, -n.z(), n.y(), n.z(), 0, -n.x(), -n.y(), n.x(), 0;
    return m;
}

/// Symmetric part of the dyad u v.
inline Mat3 sym(const Vec3& u, const Vec3& v)
{
    const Mat3 m = u * v.transpose();
    return 0.5 * (m + m.transpose());
}

}
