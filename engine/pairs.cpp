#include "engine/pairs.h"

#include "engine/error.h"
#include "engine/lanes.h"
#include "engine/lean_resize.h"
#include "engine/team.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <string>

namespace sigmaflow {

namespace {

// Pairs beyond the range cost time in every evaluation, rebuilding costs time as often as the skin
// is used up: the best skin is near the square root of this times what an evaluation uses of it.
constexpr double rebuilding_cost = 2;  // in evaluations, times a third of the reach [a]
constexpr double first_skin = 0.1, least_skin = 0.02, largest_skin = 0.4;  // [a]

int periodic(int c, int n)
{
    const int r = c % n;
    return r < 0 ? r + n : r;
}

int cell_of(double x, double length, int n)
{
    return std::min(n - 1, static_cast<int>(x / length * n));
}

// wrapped: the positions in the box
void sort_into_cells(const State& s, double reach, Cells& c)
{
    const std::vector<Vec3>& x = c.wrapped;
    // more cells than particles would cost more to visit than they save
    const int limit = std::max(1, static_cast<int>(std::cbrt(s.size())) * 2 + 1);
    auto count = [&](double length) {
        return static_cast<int>(std::clamp(length / reach, 1., static_cast<double>(limit)));
    };
    c.nx = count(s.box.length.x());
    c.ny = count(s.box.length.y());
    c.nz = count(s.box.length.z());
    c.home.resize(x.size());
    c.start.assign(static_cast<std::size_t>(c.nx) * c.ny * c.nz + 1, 0);
    for (std::size_t k = 0; k < x.size(); ++k) {
        c.home[k] = c.index(cell_of(x[k].x(), s.box.length.x(), c.nx),
                            cell_of(x[k].y(), s.box.length.y(), c.ny),
                            cell_of(x[k].z(), s.box.length.z(), c.nz));
        ++c.start[c.home[k] + 1];
    }
    for (std::size_t k = 1; k < c.start.size(); ++k) c.start[k] += c.start[k - 1];
    c.next.assign(c.start.begin(), c.start.end() - 1);
    for (auto* values : {&c.x, &c.y, &c.z, &c.radius}) values->resize(x.size());
    c.particle.resize(x.size());
    for (std::size_t k = 0; k < x.size(); ++k) {
        const int at = c.next[c.home[k]]++;
        c.particle[at] = static_cast<int>(k);
        c.x[at] = x[k].x();
        c.y[at] = x[k].y();
        c.z[at] = x[k].z();
        c.radius[at] = s.radius[k];
    }
}

void all_close_pairs(const State& s, double factor, double skin, std::vector<Candidate>& found)
{
    const Images images(s.box);
    for (int i = 0; i < s.size(); ++i)
        for (int j = i + 1; j < s.size(); ++j) {
            const Vec3 d = images.separation(s.position[i], s.position[j]).d;
            const double c = (s.radius[i] + s.radius[j]) * factor + skin;
            if (d.squaredNorm() < c * c) found.push_back({i, j});
        }
}

// How far a range of particles in cells lies beyond the cutoff from a point [a^2].
SIGMAFLOW_HOT void excess_distances(const Cells& c, int begin, int end, const Vec3& from,
                                    double radius, double factor, double skin, double* excess)
{
    const double *x = c.x.data(), *y = c.y.data(), *z = c.z.data(), *r = c.radius.data();
    for (int k = begin; k < end; ++k) {
        const double dx = x[k] - from.x(), dy = y[k] - from.y(), dz = z[k] - from.z();
        const double cutoff = (radius + r[k]) * factor + skin;
        excess[k - begin] = dx * dx + dy * dy + dz * dz - cutoff * cutoff;
    }
}

/// Finds the partners j > i of one particle after another.
class PartnerSearch {
public:
    PartnerSearch(const Box& box, const Cells& cells, double reach, double factor, double skin,
                  PairSearch::Part& part)
        : box_(box), cells_(cells), reach_(reach), factor_(factor), skin_(skin), part_(part)
    {
        part_.excess.resize(cells.particle.size());
        part_.found.clear();
    }

    void append(int i, const Vec3& x, double radius)
    {
        part_.partners.clear();
        const double width = box_.length.x() / cells_.nx;
        const int cy = cell_of(x.y(), box_.length.y(), cells_.ny);
        const int cz = cell_of(x.z(), box_.length.z(), cells_.nz);
        for (int row = cy - 1; row <= cy + 1; ++row) {
            // the image of the row above is displaced by +offset, of the row below by -offset
            const int image = row < 0 ? -1 : row >= cells_.ny ? 1 : 0;
            Vec3 centre = x;
            centre.x() -= image * box_.offset;
            centre.y() -= image * box_.length.y();
            const int first = static_cast<int>(std::floor((centre.x() - reach_) / width));
            const int last = std::min(static_cast<int>(std::floor((centre.x() + reach_) / width)),
                                      first + cells_.nx - 1);
            for (int layer = cz - 1; layer <= cz + 1; ++layer) {
                const int round = layer < 0 ? -1 : layer >= cells_.nz ? 1 : 0;
                const int home =
                    cells_.index(0, periodic(row, cells_.ny), periodic(layer, cells_.nz));
                Vec3 from = centre;
                from.z() -= round * box_.length.z();
                for (int column = first; column <= last;) {  // as far as cells lie in a line
                    const int at = periodic(column, cells_.nx);
                    const int count = std::min(cells_.nx - at, last - column + 1);
                    from.x() = centre.x() - (column - at) / cells_.nx * box_.length.x();
                    take(i, from, radius, cells_.start[home + at], cells_.start[home + at + count]);
                    column += count;
                }
            }
        }
        std::sort(part_.partners.begin(), part_.partners.end());
        for (int j : part_.partners) part_.found.push_back({i, j});
    }

private:
    void take(int i, const Vec3& from, double radius, int begin, int end)
    {
        excess_distances(cells_, begin, end, from, radius, factor_, skin_, part_.excess.data());
        for (int k = begin; k < end; ++k)
            if (part_.excess[k - begin] < 0 && cells_.particle[k] > i)
                part_.partners.push_back(cells_.particle[k]);
    }

    const Box& box_;
    const Cells& cells_;
    double reach_, factor_, skin_;
    PairSearch::Part& part_;
};

double largest_radius(const State& s)
{
    return *std::max_element(s.radius.begin(), s.radius.end());
}

}

void close_pairs(const State& state, double range, double skin, int threads, PairSearch& search,
                 std::vector<Candidate>& found)
{
    found.clear();
    if (state.radius.empty()) return;
    const double reach = largest_radius(state) * (2 + range) + skin, factor = 1 + range / 2;
    Box box = state.box;
    Cells& cells = search.cells;
    cells.wrapped = state.position;
    wrap(box, cells.wrapped);
    sort_into_cells(state, reach, cells);
    // With fewer cells a neighbour cell would be met twice; such boxes hold few particles.
    if (cells.nx < 4 || cells.ny < 3 || cells.nz < 3)
        return all_close_pairs(state, factor, skin, found);

    search.parts.resize(std::max(threads, 1));
    with_team(threads, [&](const Team& team) {
        PartnerSearch partners(box, cells, reach, factor, skin, search.parts[team.rank]);
        const Range own = team.share(0, state.size());
        for (int i = own.begin; i < own.end; ++i)
            partners.append(i, cells.wrapped[i], state.radius[i]);
    });
    std::size_t count = 0;
    for (const PairSearch::Part& part : search.parts) count += part.found.size();
    lean_resize(found, count);
    found.clear();
    for (const PairSearch::Part& part : search.parts)
        found.insert(found.end(), part.found.begin(), part.found.end());
}

std::vector<Candidate> close_pairs(const State& state, double range, double skin)
{
    PairSearch search;
    std::vector<Candidate> found;
    close_pairs(state, range, skin, 1, search, found);
    return found;
}

bool NeighbourList::update(const State& state, double range, int threads)
{
    if (covers(state, range, threads)) return false;
    rebuild(state, range, threads);
    return true;
}

void NeighbourList::rebuild(const State& state, double range, int threads)
{
    const bool follows = range == range_ && use_.updates > 0;
    skin_ = follows ? std::clamp(std::sqrt(rebuilding_cost * use_.used / use_.updates), least_skin,
                                 largest_skin)
                    : first_skin;
    range_ = range;
    use_.updates = 0;
    reach_ = state.radius.empty() ? 0 : largest_radius(state) * (2 + range);
    close_pairs(state, range, skin_, threads, search_, candidates_);
    reference_.box = state.box;
    reference_.position = state.position;
    reference_.radius = state.radius;
    reference_.strain = state.strain;
}

void check_candidates(const std::vector<Candidate>& candidates, int n)
{
    Candidate before{-1, n};
    for (const Candidate& c : candidates) {
        const bool later = c.i > before.i || (c.i == before.i && c.j > before.j);
        if (!later || c.i >= c.j || c.j >= n)
            throw Error(ErrorKind::input, "", "pairs must be sorted, i < j < " + std::to_string(n));
        before = c;
    }
}

void NeighbourList::find_again(const State& state, int threads)
{
    const auto good = [&] {
        return reference_.radius == state.radius && reference_.contacts.empty() &&
               reference_.box.length == state.box.length && range_ >= 0 && range_ < 100 &&
               skin_ >= 0 && skin_ <= largest_skin && use_.used >= 0 && use_.updates >= 0 &&
               use_.updates < std::numeric_limits<int>::max();
    };
    check_stored_state(reference_);
    if (!good()) throw Error(ErrorKind::input, "", "has neighbours of another state");
    reach_ = largest_radius(state) * (2 + range_);
    close_pairs(reference_, range_, skin_, threads, search_, candidates_);
}

// A pair in range now had |d| <= (1 + |strain|)(reach + w_i + w_j) at the rebuild, w =
// displacements relative to the affine motion since then.
bool NeighbourList::covers(const State& state, double range, int threads)
{
    if (range != range_ || state.radius != reference_.radius ||
        state.box.length != reference_.box.length)
        return false;
    const double strain = state.strain - reference_.strain;
    const double drift = state.box.offset - reference_.box.offset - strain * state.box.length.y();
    const double off = drift - std::round(drift / state.box.length.x()) * state.box.length.x();
    if (std::abs(off) > 1e-9 * state.box.length.x()) return false;
    const Images images(state.box);
    struct Largest {
        double first = 0, second = 0;  // squared displacements
        void add(double w)
        {
            second = std::max(second, std::min(first, w));
            first = std::max(first, w);
        }
    };
    Largest largest;
    std::mutex one_at_a_time;
    with_team(threads, [&](const Team& team) {
        const Range own = team.share(0, state.size());
        Largest mine;
        for (int i = own.begin; i < own.end; ++i) {
            Vec3 moved = reference_.position[i];
            moved.x() += strain * moved.y();
            mine.add(images.separation(moved, state.position[i]).d.squaredNorm());
        }
        const std::lock_guard lock(one_at_a_time);
        largest.add(mine.first);
        largest.add(mine.second);
    });
    const double now = reach_ + std::sqrt(largest.first) + std::sqrt(largest.second);
    use_.used = (1 + std::abs(strain)) * now - reach_;
    ++use_.updates;
    return use_.used <= skin_;
}

void find_pairs(const State& s, double range, const NeighbourList& list, std::vector<Pair>& pairs)
{
    pairs.clear();
    const auto& candidates = list.candidates();
    const Images images(s.box);
    for (std::size_t k = 0; k < candidates.size(); ++k) {
        const auto [i, j] = candidates[k];
        const Separation sep = images.separation(s.position[i], s.position[j]);
        const double sum = s.radius[i] + s.radius[j];
        const double reach = sum * (1 + range / 2);
        const double r2 = sep.d.squaredNorm();
        if (r2 > reach * reach * (1 + 1e-12)) continue;
        if (!(r2 > 0))
            throw Error(ErrorKind::numerics, "",
                        "the centres of particles " + std::to_string(i) + " and " +
                            std::to_string(j) + " coincide or are not finite");
        const double r = std::sqrt(r2);
        const double xi = 2 * (r - sum) / sum;
        if (xi < range) pairs.push_back({i, j, sep.image, sep.d, sep.d / r, r, r - sum, xi});
    }
}

std::vector<Pair> find_pairs(const State& state, double range, const NeighbourList& list)
{
    std::vector<Pair> pairs;
    find_pairs(state, range, list, pairs);
    return pairs;
}

}
