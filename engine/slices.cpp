#include "engine/slices.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sigmaflow {

namespace {

/// Neighbours of every particle, and which candidate each is.
struct Graph {
    std::vector<int> start, neighbour, candidate;
};

Graph graph_of(int n, const std::vector<Candidate>& candidates)
{
    Graph g;
    g.start.assign(n + 1, 0);
    for (const auto [i, j] : candidates) {
        ++g.start[i + 1];
        ++g.start[j + 1];
    }
    for (int i = 0; i < n; ++i) g.start[i + 1] += g.start[i];
    std::vector<int> next(g.start.begin(), g.start.end() - 1);
    g.neighbour.resize(2 * candidates.size());
    g.candidate.resize(2 * candidates.size());
    for (std::size_t k = 0; k < candidates.size(); ++k) {
        const auto [i, j] = candidates[k];
        g.neighbour[next[i]] = j;
        g.candidate[next[i]++] = static_cast<int>(k);
        g.neighbour[next[j]] = i;
        g.candidate[next[j]++] = static_cast<int>(k);
    }
    return g;
}

// Along the gradient direction: the preconditioner then needs fewer iterations than in any order.
std::vector<int> spatial_order(const State& s)
{
    std::vector<int> order(s.size());
    for (int i = 0; i < s.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](int i, int j) {
        const double yi = s.position[i].y(), yj = s.position[j].y();
        return yi < yj || (yi == yj && i < j);
    });
    return order;
}

std::vector<int> colours_of(const std::vector<int>& order, const Graph& g)
{
    std::vector<int> colour(order.size(), -1), used_by;
    for (int i : order) {
        for (int k = g.start[i]; k < g.start[i + 1]; ++k)
            if (const int c = colour[g.neighbour[k]]; c >= 0) used_by[c] = i;
        int c = 0;
        while (c < static_cast<int>(used_by.size()) && used_by[c] == i) ++c;
        if (c == static_cast<int>(used_by.size())) used_by.push_back(-1);
        colour[i] = c;
    }
    return colour;
}

/// Pairs of the lanes of one slice, filled up to the longest.
template <class Emit>
int emit_groups(const std::array<std::vector<std::array<int, 2>>, lanes>& lists, const Emit& emit)
{
    std::size_t longest = 0;
    for (const auto& list : lists) longest = std::max(longest, list.size());
    for (std::size_t k = 0; k < longest; ++k)
        for (int l = 0; l < lanes; ++l) emit(l, k < lists[l].size() ? &lists[l][k] : nullptr);
    return static_cast<int>(longest);
}

}

Slices make_slices(const State& state, const std::vector<Candidate>& candidates)
{
    Slices s;
    const int n = state.size();
    s.particles = n;
    const Graph g = graph_of(n, candidates);
    const std::vector<int> order = spatial_order(state);
    const std::vector<int> colour = colours_of(order, g);
    const int colours = n > 0 ? *std::max_element(colour.begin(), colour.end()) + 1 : 0;

    // earlier and later neighbours; lanes of one slice should have about as many of both
    std::vector<std::array<int, 2>> degree(n, {0, 0});
    for (const auto [i, j] : candidates) {
        ++degree[i][colour[j] > colour[i]];
        ++degree[j][colour[i] > colour[j]];
    }
    // neighbours in memory should be neighbours in space, and members of a team have different parts
    const int block = std::clamp(n / 8, 64, 2048);
    std::vector<int> rank(n);
    for (int k = 0; k < n; ++k) rank[order[k]] = k / block;
    std::vector<int> sorted = order;
    std::stable_sort(sorted.begin(), sorted.end(), [&](int i, int j) {
        return std::array{colour[i], rank[i], degree[i][0], degree[i][1]} <
               std::array{colour[j], rank[j], degree[j][0], degree[j][1]};
    });

    s.slot.resize(n);
    s.colour.assign(1, 0);
    for (int c = 0, k = 0; c < colours; ++c) {
        while (k < n && colour[sorted[k]] == c) {
            s.slot[sorted[k]] = static_cast<int>(s.particle.size());
            s.particle.push_back(sorted[k++]);
        }
        while (s.particle.size() % lanes) s.particle.push_back(-1);
        s.colour.push_back(static_cast<int>(s.particle.size()) / lanes);
    }
    s.count = s.colour.back();

    s.pair_of.resize(candidates.size());
    s.flipped.resize(candidates.size());
    s.upper.assign(1, 0);
    std::array<std::vector<std::array<int, 2>>, lanes> lists;  // slot of the other, candidate
    const auto neighbours = [&](int slice, bool later) {
        for (int l = 0; l < lanes; ++l) {
            lists[l].clear();
            const int own = slice * lanes + l, i = s.particle[own];
            if (i < 0) continue;
            for (int k = g.start[i]; k < g.start[i + 1]; ++k) {
                const int other = s.slot[g.neighbour[k]];
                if ((other > own) == later) lists[l].push_back({other, g.candidate[k]});
            }
            std::sort(lists[l].begin(), lists[l].end());
        }
    };
    for (int slice = 0; slice < s.count; ++slice) {
        neighbours(slice, true);
        const int longest = emit_groups(lists, [&](int l, const std::array<int, 2>* entry) {
            const int own = slice * lanes + l;
            if (entry) {
                s.pair_of[(*entry)[1]] = static_cast<int>(s.first.size());
                s.flipped[(*entry)[1]] = candidates[(*entry)[1]].i != s.particle[own];
            }
            s.first.push_back(own);
            s.second.push_back(entry ? (*entry)[0] : s.slots());
        });
        s.upper.push_back(s.upper.back() + longest);
    }
    s.lower.assign(1, 0);
    for (int slice = 0; slice < s.count; ++slice) {
        neighbours(slice, false);
        const int longest = emit_groups(lists, [&](int, const std::array<int, 2>* entry) {
            s.lower_pair.push_back(entry ? s.pair_of[(*entry)[1]] : s.pairs());
            s.lower_slot.push_back(entry ? (*entry)[0] : s.slots());
        });
        s.lower.push_back(s.lower.back() + longest);
    }
    return s;
}

void to_slices(const Velocities& v, const Slices& s, SlicedVector& result)
{
    result.assign(s.count + 1, Slice6{});
    for (int i = 0; i < s.particles; ++i)
        for (int c = 0; c < 6; ++c) result[s.slot[i] / lanes].c[c][s.slot[i] % lanes] = v[i][c];
}

void from_slices(const SlicedVector& v, const Slices& s, Velocities& result)
{
    result.resize(s.particles);
    for (int i = 0; i < s.particles; ++i)
        for (int c = 0; c < 6; ++c) result[i][c] = v[s.slot[i] / lanes].c[c][s.slot[i] % lanes];
}

double dot(const SlicedVector& u, const SlicedVector& v)
{
    d8 sum{};
    for (std::size_t k = 0; k < u.size(); ++k)
        for (int c = 0; c < 6; ++c) sum += u[k].c[c] * v[k].c[c];
    return total(sum);
}

}
