// tests/support/random_state.h -- reproducible random vectors and small states for tests.
#pragma once
#include "engine/packing.h"
#include "engine/pairs.h"
#include "engine/state.h"
#include "engine/types.h"

#include <algorithm>
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

/// Pushes spheres apart until none overlaps by more than `overlap` of the mean radius.
inline void relax(State& s, double overlap)
{
    NeighbourList list;
    for (double smallest = -1; smallest < -overlap;) {
        smallest = 0;
        list.update(s, 0);
        for (const Pair& pair : find_pairs(s, 0, list)) {
            const Vec3 push = 0.3 * pair.gap * pair.normal;  // gap < 0
            s.position[pair.i] += push;
            s.position[pair.j] -= push;
            smallest = std::min(smallest, pair.xi);
        }
        wrap(s.box, s.position);
    }
}

/// A dense state with gaps, touching pairs and a sheared boundary.
inline State dense_state(int n, double phi, double offset_share, unsigned seed)
{
    PackingParameters p;
    p.particles = n;
    p.volume_fraction = phi;
    p.seed = seed;
    State s = random_packing(p);
    s.box.offset = offset_share * s.box.length.x();
    relax(s, 0.02);  // pairs across the boundary
    return s;
}

}
