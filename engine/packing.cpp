#include "engine/packing.h"

#include "engine/error.h"
#include "engine/pairs.h"
#include "engine/random.h"
#include "engine/units.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace sigmaflow {

namespace {

constexpr double enlargement = 1.01, accepted_xi = -0.01;
constexpr double step_factor = 0.3, largest_move = 0.1;  // [a]

void require(bool good, const char* name, const std::string& problem)
{
    if (!good) throw Error(ErrorKind::input, name, problem);
}

}

std::vector<double> packing_radii(const PackingParameters& p)
{
    if (!p.radii.empty()) return p.radii;
    const double small = p.small_volume_share, large = 1 - small;
    const double ratio3 = std::pow(p.size_ratio, 3);
    // numbers are proportional to volume share over volume of one
    const int smalls =
        static_cast<int>(std::lround(p.particles * small / (small + large / ratio3)));
    std::vector<double> radii(p.particles, p.size_ratio);
    std::fill(radii.begin(), radii.begin() + smalls, 1.);
    return radii;
}

double random_close_packing(const std::vector<double>& radii)
{
    constexpr double equal_spheres = 0.64;
    const double n = static_cast<double>(radii.size());
    double mean = 0, solid = 0, second = 0, third = 0;
    for (double a : radii) {
        mean += a / n;
        solid += a * a * a;
    }
    for (double a : radii) {
        const double from_mean = a / mean - 1;
        second += from_mean * from_mean / n;
        third += from_mean * from_mean * from_mean / n;
    }
    // skewness times the square of the polydispersity
    const double skew = second > 0 ? third / std::sqrt(second) : 0;
    double limit = equal_spheres + 0.0658 * std::sqrt(second) + 0.0857 * skew;

    std::vector<double> sorted = radii;
    std::sort(sorted.begin(), sorted.end(), std::greater<>());
    double larger = 0;  // share of the solid volume
    for (auto first = sorted.begin(); first != sorted.end();) {
        const auto last = std::upper_bound(first, sorted.end(), *first, std::greater<>());
        const double own = static_cast<double>(last - first) * std::pow(*first, 3) / solid;
        limit = std::min(limit, 1 / (larger + own / equal_spheres));
        larger += own;
        first = last;
    }
    return std::max(std::round(1e4 * limit) / 1e4, equal_spheres);
}

namespace {

void check(const PackingParameters& p)
{
    require(p.particles >= 1 || !p.radii.empty(), "particles", "must be >= 1");
    require(p.box_shape.minCoeff() > 0, "box_shape", "lengths must be > 0");
    for (double a : p.radii) require(a > 0 && std::isfinite(a), "radii", "must be > 0");
    const double limit = random_close_packing(packing_radii(p));
    require(p.volume_fraction > 0 && p.volume_fraction <= limit, "volume_fraction",
            "must be > 0 and <= " + std::to_string(limit) + ", random close packing, got " +
                std::to_string(p.volume_fraction));
}

// Force of the overlap energy sum (1/2) abar (s - r)^2 on each sphere; returns the smallest xi.
double overlap_forces(const State& s, const NeighbourList& list, std::vector<Vec3>& force)
{
    force.assign(s.size(), Vec3::Zero());
    double smallest = 0;
    for (const Pair& pair : find_pairs(s, 0, list)) {
        const double mean = (s.radius[pair.i] + s.radius[pair.j]) / 2;
        const Vec3 push = mean * pair.gap * pair.normal;  // gap < 0: i is pushed against n
        force[pair.i] += push;
        force[pair.j] -= push;
        smallest = std::min(smallest, pair.xi);
    }
    return smallest;
}

Vec3 box_of(const PackingParameters& p, const std::vector<double>& radii)
{
    double solid = 0;
    for (double a : radii) solid += 4 * pi / 3 * a * a * a;
    return p.box_shape * std::cbrt(solid / p.volume_fraction / p.box_shape.prod());
}

// Distance by which the longest diagonal neighbour of a particle lies within half a box.
void check_box(const State& s)
{
    const double largest = *std::max_element(s.radius.begin(), s.radius.end());
    if (s.size() > 1 && s.box.length.minCoeff() < 2 * 2 * largest)
        throw Error(ErrorKind::input, "particles",
                    "too few: the box is less than two of the largest spheres wide (" +
                        std::to_string(s.box.length.minCoeff()) +
                        " a), so that nearest images are "
                        "not unique");
}

}

Vec3 packing_box(const PackingParameters& p)
{
    check(p);
    return box_of(p, packing_radii(p));
}

State random_packing(const PackingParameters& p, const PackingProgress& progress)
{
    check(p);
    State s;
    s.radius = packing_radii(p);
    s.box.length = box_of(p, s.radius);
    check_box(s);
    for (int i = 0; i < s.size(); ++i) {
        const auto u = [&](int axis) { return uniform(p.seed, 0, 3 * std::uint64_t(i) + axis); };
        s.position.push_back(Vec3(u(0), u(1), u(2)).cwiseProduct(s.box.length));
    }
    std::vector<double> true_radius = s.radius;
    for (double& a : s.radius) a *= enlargement;
    NeighbourList list;
    std::vector<Vec3> force;
    double smallest = -1;
    for (int iteration = 0; iteration <= p.max_iterations; ++iteration) {
        list.update(s, 0);
        smallest = overlap_forces(s, list, force);
        if (smallest > accepted_xi) {
            s.radius = std::move(true_radius);
            return s;
        }
        if (progress && iteration % 100 == 0) progress(iteration, smallest);
        for (int i = 0; i < s.size(); ++i) {
            const Vec3 move = step_factor / s.radius[i] * force[i];
            const double size = move.norm();
            s.position[i] += size > largest_move ? Vec3(largest_move / size * move) : move;
        }
        wrap(s.box, s.position);
    }
    throw Error(ErrorKind::numerics, "volume_fraction",
                "no packing without overlaps found in " + std::to_string(p.max_iterations) +
                    " iterations (smallest xi " + std::to_string(smallest) +
                    "); try another seed or a lower volume fraction");
}

}
