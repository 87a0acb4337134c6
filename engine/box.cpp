#include "engine/box.h"

#include <cmath>

namespace sigmaflow {

namespace {

// x - floor(x/L) L can round to L itself for a tiny negative x. What is not a number stays so.
double into_period(double x, double length)
{
    const double y = x - std::floor(x / length) * length;
    return y >= length ? 0. : y;
}

}

void wrap(Box& box, std::vector<Vec3>& positions)
{
    for (Vec3& x : positions) {
        double c = std::floor(x.y() / box.length.y());
        double y = x.y() - c * box.length.y();
        if (y >= box.length.y()) {
            y = 0;
            c += 1;
        }
        x.y() = y;
        x.x() = into_period(x.x() - c * box.offset, box.length.x());
        x.z() = into_period(x.z(), box.length.z());
    }
    box.offset = into_period(box.offset, box.length.x());
}

}
