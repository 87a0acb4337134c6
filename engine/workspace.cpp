#include "engine/workspace.h"

#include "engine/checks.h"
#include "engine/lean_resize.h"
#include "engine/team.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace sigmaflow {

Workspace::Workspace(const SolverSettings& solver) : buffers_(std::make_unique<Buffers>(solver)) {}
Workspace::~Workspace() = default;
Workspace::Workspace(Workspace&&) noexcept = default;
Workspace& Workspace::operator=(Workspace&&) noexcept = default;

double SolutionHistory::guess(double at, int particles, int threads, Velocities& v) const
{
    v.clear();
    if (known == 0 || solution[0].size() != static_cast<std::size_t>(particles)) return 0;
    v = solution[0];
    const double interval = time[0] - time[1], ahead = at - time[0];
    // beyond a few intervals a straight line is worse than the last value
    if (known == 1 || ahead == 0 || !(std::abs(ahead) < 4 * std::abs(interval))) return rate[0];
    const double weight = ahead / interval;
    for_each(threads, v.size(), [&](int i) { v[i] += weight * (solution[0][i] - solution[1][i]); });
    return rate[0] + weight * (rate[0] - rate[1]);
}

void SolutionHistory::remember(double at, const Velocities& v, double shear_rate)
{
    if (known > 0 && solution[0].size() != v.size()) known = 0;
    if (known > 0 && at != time[0]) {
        std::swap(solution[0], solution[1]);
        time[1] = time[0];
        rate[1] = rate[0];
        known = 2;
    }
    known = std::max(known, 1);
    time[0] = at;
    rate[0] = shear_rate;
    solution[0] = v;
}

void recycle(Evaluation&& evaluation, Workspace& workspace)
{
    // a step needs two; copies that callers made must not pile up
    auto& spare = workspace.buffers().spare;
    if (spare.size() < 2) spare.push_back(std::move(evaluation));
}

void make_pattern(const State& s, Workspace::Buffers& b)
{
    const auto& candidates = b.neighbours.candidates();
    b.solver.set_pattern(s.size(), candidates);
    b.slice_maker.make(s, candidates, b.slices);
    make_shapes(s, b.slices, b.threads, b.table);
    const std::size_t count = b.slices.count + 1;
    b.matrix.slices = &b.slices;
    lean_resize(b.matrix.pairs, b.slices.groups() + 1);
    b.matrix.pairs.back() = PairGroup{};
    b.matrix.drag.resize(2 * count);
    b.rows.resize(count * lanes);
    b.moment.resize(count);
    b.affine.resize(count);
    b.unit_load.resize(count);
    b.unit_load.back() = Slice6{};
    b.fixed_load.resize(count);
    b.fixed_load.back() = Slice6{};
    b.right.resize(count);
    b.right.back() = Slice6{};
}

namespace {

void find_touching(const State& s, Workspace::Buffers& b)
{
    b.touching_parts.resize(std::max(b.threads, 1));
    const auto& candidates = b.neighbours.candidates();
    with_team(b.threads, [&](const Team& team) {
        std::vector<int>& found = b.touching_parts[team.rank];
        found.clear();
        const Range own = team.share(0, static_cast<int>(candidates.size()));
        for (int k = own.begin; k < own.end; ++k) {
            const int pair = b.slices.pair_of[k];
            if (b.table.geometry[pair / lanes].xi[pair % lanes] <= 0) found.push_back(k);
        }
    });
    b.touching.clear();
    for (const auto& part : b.touching_parts)
        b.touching.insert(b.touching.end(), part.begin(), part.end());
    lean_resize(b.touching_pairs, b.touching.size());
    for_each(b.threads, b.touching.size(), [&](int k) {
        const int candidate = b.touching[k];
        const int pair = b.slices.pair_of[candidate], l = pair % lanes;
        const PairGeometry& g = b.table.geometry[pair / lanes];
        const double sign = b.slices.flipped[candidate] ? -1 : 1;
        const auto [i, j] = candidates[candidate];
        const Vec3 normal = sign * Vec3(g.nx[l], g.ny[l], g.nz[l]);
        b.touching_pairs[k] = {i,
                               j,
                               static_cast<int>(sign * g.image[l]),
                               g.distance[l] * normal,
                               normal,
                               g.distance[l],
                               g.distance[l] - s.radius[i] - s.radius[j],
                               g.xi[l]};
    });
}

}

void locate(const State& s, const Model& m, Workspace::Buffers& b)
{
    const double range = interaction_range(m);
    if (b.located && b.range == range && b.box.offset == s.box.offset &&
        b.box.length == s.box.length && b.position == s.position && b.radius == s.radius)
        return;
    b.located = false;
    check_geometry(s);
    if (b.neighbours.update(s, range, b.threads)) make_pattern(s, b);
    std::atomic<bool> good = true;
    with_team(b.threads, [&](const Team& team) {
        team.own(b.slices, [&](Range own) { write_positions(s, b.slices, own, b.row_values()); });
        if (team.rank == 0)  // the particle of unused lanes, where no other is
            std::fill_n(b.row_values() + 4 * b.slices.slots(), 3, -s.box.length.x() / 3);
        team.barrier();
        team.own(b.slices, [&](Range own) {
            if (!find_geometry(b.slices, s.box, b.row_values(), own, b.table)) good = false;
        });
    });
    if (!good) find_pairs(s, range, b.neighbours);  // throws and says which centres coincide
    find_touching(s, b);
    b.position = s.position;
    b.radius = s.radius;
    b.box = s.box;
    b.range = range;
    b.located = true;
}

}
