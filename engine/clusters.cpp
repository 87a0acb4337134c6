#include "engine/clusters.h"

#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace sigmaflow {

namespace {

using Winding = std::array<long, 3>;  // in the order y, x, z

Winding sum(const Winding& a, const Winding& b, long sign)
{
    return {a[0] + sign * b[0], a[1] + sign * b[1], a[2] + sign * b[2]};
}

/// The cells between the image of j at the end of a contact and that at the stored position, as
/// seen from the stored position of i.
Winding cells_crossed(const State& s, const ContactForce& c)
{
    const Vec3& length = s.box.length;
    const Vec3 beyond = (c.end - c.start) - (s.position[c.j] - s.position[c.i]);
    const double y = std::round(beyond.y() / length.y());
    const double x = std::round((beyond.x() - y * s.box.offset) / length.x());
    return {std::lround(y), std::lround(x), std::lround(beyond.z() / length.z())};
}

/// Independent windings, each with its first component that is not zero at another place.
class Lattice {
public:
    void add(Winding w)
    {
        for (std::size_t k = 0; k < 3; ++k) {
            if (w[k] == 0) continue;
            if (!used_[k]) {
                used_[k] = true;
                rows_[k] = w;
                return;
            }
            const Winding& row = rows_[k];
            const long a = row[k], b = w[k];
            for (std::size_t m = 0; m < 3; ++m) w[m] = a * w[m] - b * row[m];
            const long common = std::gcd(std::gcd(w[0], w[1]), w[2]);
            if (common > 1)
                for (long& m : w) m /= common;
        }
    }
    bool gradient() const { return used_[0]; }
    bool flow() const { return used_[1]; }
    bool vorticity() const
    {
        return used_[2] || (used_[0] && rows_[0][2] != 0) || (used_[1] && rows_[1][2] != 0);
    }

private:
    std::array<bool, 3> used_{};
    std::array<Winding, 3> rows_{};
};

struct Edge {
    int to;
    Winding crossed;
};

}

std::vector<Cluster> clusters(const Frame& frame)
{
    const auto n = static_cast<std::size_t>(frame.state.size());
    std::vector<std::vector<Edge>> edges(n);
    for (const ContactForce& c : frame.contacts) {
        const Winding w = cells_crossed(frame.state, c);
        edges[c.i].push_back({c.j, w});
        edges[c.j].push_back({c.i, sum({}, w, -1)});
    }
    std::vector<bool> seen(n, false);
    std::vector<Winding> image(n);  // of the particle that the walk came to first
    std::vector<Cluster> result;
    std::vector<int> waiting;
    for (std::size_t first = 0; first < n; ++first) {
        if (seen[first]) continue;
        Cluster cluster;
        Lattice lattice;
        seen[first] = true;
        waiting.push_back(static_cast<int>(first));
        while (!waiting.empty()) {
            const int i = waiting.back();
            waiting.pop_back();
            ++cluster.size;
            for (const auto& [j, crossed] : edges[i]) {
                const Winding here = sum(image[i], crossed, 1);
                if (seen[j]) {
                    lattice.add(sum(here, image[j], -1));
                    continue;
                }
                seen[j] = true;
                image[j] = here;
                waiting.push_back(j);
            }
        }
        cluster.flow = lattice.flow();
        cluster.gradient = lattice.gradient();
        cluster.vorticity = lattice.vorticity();
        result.push_back(cluster);
    }
    return result;
}

}
