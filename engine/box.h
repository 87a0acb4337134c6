// engine/box.h -- the sheared periodic box (Lees & Edwards, J. Phys. C 5, 1921, 1972).
//
// length   Lx, Ly, Lz [a] > 0
// offset   displacement D of the image cell above (y + Ly) along x [a]; dD/dt = shear_rate Ly
//
// The nearest image is unique while every interaction range is below half of each box length.
#pragma once
#include "engine/types.h"

#include <cmath>
#include <vector>

namespace sigmaflow {

struct Box {
    Vec3 length{1, 1, 1};
    double offset = 0;

    double volume() const { return length.prod(); }
};

template <class Archive>
void archive(Archive& a, Box& box)
{
    a(box.length, box.offset);
}

/// Nearest integer, halves to even; two additions instead of a library call. |x| < 2^51.
inline double nearest_integer(double x)
{
    constexpr double magic = 0x1.8p52;
    return (x + magic) - magic;
}

/// Vector from a point to the nearest image of another one, and the row of images it lies in: the
/// image moves with U + image * shear_rate * Ly e_x. Points may lie any number of cells away.
struct Separation {
    Vec3 d;
    int image;
};

/// Nearest images in one box for many pairs: the divisions are done once.
class Images {
public:
    explicit Images(const Box& box)
        : length_(box.length), inverse_(box.length.cwiseInverse()), offset_(box.offset)
    {
    }

    Separation separation(const Vec3& from, const Vec3& to) const
    {
        Vec3 d = to - from;
        const double q = -nearest_integer(d.y() * inverse_.y());
        d.y() += q * length_.y();
        d.x() += q * offset_;
        d.x() -= length_.x() * nearest_integer(d.x() * inverse_.x());
        d.z() -= length_.z() * nearest_integer(d.z() * inverse_.z());
        return {d, static_cast<int>(q)};
    }

private:
    Vec3 length_, inverse_;
    double offset_;
};

inline Separation separation(const Box& box, const Vec3& from, const Vec3& to)
{
    return Images(box).separation(from, to);
}

/// Brings every point into [0, Lx) x [0, Ly) x [0, Lz) and the offset into [0, Lx).
void wrap(Box& box, std::vector<Vec3>& positions);

}
