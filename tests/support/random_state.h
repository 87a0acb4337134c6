// tests/support/random_state.h -- reproducible random vectors and small states for tests.
#pragma once
#include "engine/packing.h"
#include "engine/state.h"
#include "engine/types.h"

#include <random>

namespace sigmaflow::support {

class Random {
public:
    explicit Random(unsigned seed) : generator_(seed) {}
    double uniform(double low, double high)
    {
        return std::uniform_real_distribution<double>(low, high)(generator_);
    }
    Vec3 vector(double size = 1)
    {
        return Vec3(uniform(-size, size), uniform(-size, size), uniform(-size, size));
    }
    Vec3 direction()
    {
        Vec3 v = vector();
        while (v.norm() < 0.1) v = vector();
        return v.normalized();
    }
    Vec6 velocity()
    {
        Vec6 v;
        v << vector(), vector();
        return v;
    }
    Mat3 traceless()
    {
        Mat3 m;
        m << vector(), vector(), vector();
        m = 0.5 * (m + m.transpose()).eval();
        return m - m.trace() / 3 * Mat3::Identity();
    }

private:
    std::mt19937 generator_;
};

/// A dense state with gaps, contacts with springs, and a sheared boundary.
inline State dense_state(int n, double phi, double offset_share, unsigned seed)
{
    PackingParameters p;
    p.particles = n;
    p.volume_fraction = phi;
    p.seed = seed;
    State s = random_packing(p);
    s.box.offset = offset_share * s.box.length.x();
    return s;
}

}
