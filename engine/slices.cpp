#include "engine/slices.h"

#include "engine/lean_resize.h"
#include "engine/team.h"

#include <algorithm>

namespace sigmaflow {

void SliceMaker::connect(int n, const std::vector<Candidate>& candidates)
{
    Graph& g = graph_;
    g.start.assign(n + 1, 0);
    for (const auto [i, j] : candidates) {
        ++g.start[i + 1];
        ++g.start[j + 1];
    }
    for (int i = 0; i < n; ++i) g.start[i + 1] += g.start[i];
    g.next.assign(g.start.begin(), g.start.end() - 1);
    lean_resize(g.neighbour, 2 * candidates.size());
    lean_resize(g.candidate, 2 * candidates.size());
    for (std::size_t k = 0; k < candidates.size(); ++k) {
        const auto [i, j] = candidates[k];
        g.neighbour[g.next[i]] = j;
        g.candidate[g.next[i]++] = static_cast<int>(k);
        g.neighbour[g.next[j]] = i;
        g.candidate[g.next[j]++] = static_cast<int>(k);
    }
}

// Along the gradient direction: the preconditioner needs the fewest iterations then.
void SliceMaker::order_in_space(const State& s)
{
    order_.resize(s.size());
    for (int i = 0; i < s.size(); ++i) order_[i] = i;
    std::sort(order_.begin(), order_.end(), [&](int i, int j) {
        const double yi = s.position[i].y(), yj = s.position[j].y();
        return yi < yj || (yi == yj && i < j);
    });
}

// Greedy: the first colour that no neighbour has. Returns the number of colours.
int SliceMaker::find_colours()
{
    colour_.assign(order_.size(), -1);
    used_by_.clear();
    for (int i : order_) {
        for (int k = graph_.start[i]; k < graph_.start[i + 1]; ++k)
            if (const int c = colour_[graph_.neighbour[k]]; c >= 0) used_by_[c] = i;
        const int colours = static_cast<int>(used_by_.size());
        int c = 0;
        while (c < colours && used_by_[c] == i) ++c;
        if (c == colours) used_by_.push_back(-1);
        colour_[i] = c;
    }
    return static_cast<int>(used_by_.size());
}

// Earlier or later neighbours of the lanes of one slice.
void SliceMaker::find_neighbours(const Slices& s, int slice, bool later)
{
    for (int l = 0; l < lanes; ++l) {
        lists_[l].clear();
        const int own = slice * lanes + l, i = s.particle[own];
        if (i < 0) continue;
        for (int k = graph_.start[i]; k < graph_.start[i + 1]; ++k) {
            const int other = s.slot[graph_.neighbour[k]];
            if ((other > own) == later) lists_[l].push_back({other, graph_.candidate[k]});
        }
        std::sort(lists_[l].begin(), lists_[l].end());
    }
}

namespace {

// emit(lane, entry or null) for all lanes, filled up to the longest list; returns its length.
template <class Lists, class Emit>
int emit_groups(const Lists& lists, const Emit& emit)
{
    std::size_t longest = 0;
    for (const auto& list : lists) longest = std::max(longest, list.size());
    for (std::size_t k = 0; k < longest; ++k)
        for (int l = 0; l < lanes; ++l) emit(l, k < lists[l].size() ? &lists[l][k] : nullptr);
    return static_cast<int>(longest);
}

}

void SliceMaker::make(const State& state, const std::vector<Candidate>& candidates, Slices& s)
{
    const int n = state.size();
    s.particles = n;
    connect(n, candidates);
    order_in_space(state);
    const int colours = find_colours();

    // lanes of one slice should have about as many earlier and later neighbours
    degree_.assign(n, {0, 0});
    for (const auto [i, j] : candidates) {
        ++degree_[i][colour_[j] > colour_[i]];
        ++degree_[j][colour_[i] > colour_[j]];
    }
    // neighbours in memory should be neighbours in space, and members of a team have different
    // parts
    const int block = std::clamp(n / 8, 64, 2048);
    rank_.resize(n);
    for (int k = 0; k < n; ++k) rank_[order_[k]] = k / block;
    const auto key = [&](int i) {
        return std::array{colour_[i], rank_[i], degree_[i][0], degree_[i][1], i};
    };
    sorted_ = order_;
    std::sort(sorted_.begin(), sorted_.end(), [&](int i, int j) { return key(i) < key(j); });

    s.slot.resize(n);
    s.particle.clear();
    s.colour.assign(1, 0);
    for (int c = 0, k = 0; c < colours; ++c) {
        while (k < n && colour_[sorted_[k]] == c) {
            s.slot[sorted_[k]] = static_cast<int>(s.particle.size());
            s.particle.push_back(sorted_[k++]);
        }
        while (s.particle.size() % lanes) s.particle.push_back(-1);
        s.colour.push_back(static_cast<int>(s.particle.size()) / lanes);
    }
    s.count = s.colour.back();

    lean_resize(s.pair_of, candidates.size());
    lean_resize(s.flipped, candidates.size());
    // unused lanes make the groups longer by about a third
    for (auto* list : {&s.first, &s.second, &s.lower_pair, &s.lower_slot}) {
        lean_resize(*list, candidates.size() + candidates.size() / 3);
        list->clear();
    }
    s.upper.assign(1, 0);
    for (int slice = 0; slice < s.count; ++slice) {
        find_neighbours(s, slice, true);
        const int longest = emit_groups(lists_, [&](int l, const Entry* entry) {
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
        find_neighbours(s, slice, false);
        const int longest = emit_groups(lists_, [&](int, const Entry* entry) {
            s.lower_pair.push_back(entry ? s.pair_of[(*entry)[1]] : s.pairs());
            s.lower_slot.push_back(entry ? (*entry)[0] : s.slots());
        });
        s.lower.push_back(s.lower.back() + longest);
    }
}

void to_slices(const Velocities& v, const Slices& s, SlicedVector& result, int threads)
{
    result.resize(s.count + 1);
    result.back() = Slice6{};
    for_each(threads, s.count, [&](int k) {
        for (int l = 0; l < lanes; ++l) {
            const int i = s.particle[k * lanes + l];
            for (int c = 0; c < 6; ++c) result[k].c[c][l] = i < 0 ? 0 : v[i][c];
        }
    });
}

void from_slices(const SlicedVector& v, const Slices& s, Velocities& result, int threads)
{
    result.resize(s.particles);
    for_each(threads, s.particles, [&](int i) {
        for (int c = 0; c < 6; ++c) result[i][c] = v[s.slot[i] / lanes].c[c][s.slot[i] % lanes];
    });
}

double dot(const SlicedVector& u, const SlicedVector& v)
{
    d8 sum{};
    for (std::size_t k = 0; k < u.size(); ++k)
        for (int c = 0; c < 6; ++c) sum += u[k].c[c] * v[k].c[c];
    return total(sum);
}

}
