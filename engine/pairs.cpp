#include "engine/pairs.h"

#include "engine/error.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace sigmaflow {

namespace {

constexpr double skin_in_radii = 0.1;  // of the largest radius

/// Cells of at least the reach in y and z, and in x; the particles of each cell in ascending order.
struct Cells {
    int nx, ny, nz;
    std::vector<int> start, particle;

    int index(int cx, int cy, int cz) const { return (cz * ny + cy) * nx + cx; }
};

int periodic(int c, int n)
{
    const int r = c % n;
    return r < 0 ? r + n : r;
}

int cell_of(double x, double length, int n)
{
    return std::min(n - 1, static_cast<int>(x / length * n));
}

Cells sort_into_cells(const State& s, const std::vector<Vec3>& x, double reach)
{
    Cells c;
    // more cells than particles would cost more to visit than they save
    const int limit = std::max(1, static_cast<int>(std::cbrt(s.size())) * 2 + 1);
    auto count = [&](double length) {
        return std::clamp(static_cast<int>(length / reach), 1, limit);
    };
    c.nx = count(s.box.length.x());
    c.ny = count(s.box.length.y());
    c.nz = count(s.box.length.z());
    std::vector<int> home(x.size());
    c.start.assign(static_cast<std::size_t>(c.nx) * c.ny * c.nz + 1, 0);
    for (std::size_t k = 0; k < x.size(); ++k) {
        home[k] = c.index(cell_of(x[k].x(), s.box.length.x(), c.nx),
                          cell_of(x[k].y(), s.box.length.y(), c.ny),
                          cell_of(x[k].z(), s.box.length.z(), c.nz));
        ++c.start[home[k] + 1];
    }
    for (std::size_t k = 1; k < c.start.size(); ++k) c.start[k] += c.start[k - 1];
    c.particle.resize(x.size());
    std::vector<int> next(c.start.begin(), c.start.end() - 1);
    for (std::size_t k = 0; k < x.size(); ++k) c.particle[next[home[k]]++] = static_cast<int>(k);
    return c;
}

double cutoff(const State& s, int i, int j, double range, double skin)
{
    return (s.radius[i] + s.radius[j]) * (1 + range / 2) + skin;
}

void take_if_close(const State& s, int i, int j, double range, double skin,
                   std::vector<Candidate>& found)
{
    const Vec3 d = separation(s.box, s.position[i], s.position[j]).d;
    const double c = cutoff(s, i, j, range, skin);
    if (d.squaredNorm() < c * c) found.push_back({i, j});
}

std::vector<Candidate> all_close_pairs(const State& s, double range, double skin)
{
    std::vector<Candidate> found;
    for (int i = 0; i < s.size(); ++i)
        for (int j = i + 1; j < s.size(); ++j) take_if_close(s, i, j, range, skin, found);
    return found;
}

double largest_radius(const State& s)
{
    return *std::max_element(s.radius.begin(), s.radius.end());
}

}

std::vector<Candidate> close_pairs(const State& state, double range, double skin)
{
    if (state.radius.empty()) return {};
    const double reach = largest_radius(state) * (2 + range) + skin;
    Box box = state.box;
    std::vector<Vec3> x = state.position;
    wrap(box, x);
    const Cells cells = sort_into_cells(state, x, reach);
    // With fewer cells a neighbour cell would be met twice; such boxes hold few particles.
    if (cells.nx < 4 || cells.ny < 3 || cells.nz < 3) return all_close_pairs(state, range, skin);

    const double width = box.length.x() / cells.nx;
    std::vector<Candidate> found;
    std::vector<int> partners;
    for (int i = 0; i < state.size(); ++i) {
        partners.clear();
        const int cy = cell_of(x[i].y(), box.length.y(), cells.ny);
        const int cz = cell_of(x[i].z(), box.length.z(), cells.nz);
        for (int row = cy - 1; row <= cy + 1; ++row) {
            // the image of the row above is displaced by +offset, of the row below by -offset
            const double shift = row < 0 ? -box.offset : row >= cells.ny ? box.offset : 0.;
            const double centre = x[i].x() - shift;
            const int first = static_cast<int>(std::floor((centre - reach) / width));
            const int last = std::min(static_cast<int>(std::floor((centre + reach) / width)),
                                      first + cells.nx - 1);
            for (int layer = cz - 1; layer <= cz + 1; ++layer)
                for (int column = first; column <= last; ++column) {
                    const int home =
                        cells.index(periodic(column, cells.nx), periodic(row, cells.ny),
                                    periodic(layer, cells.nz));
                    for (int k = cells.start[home]; k < cells.start[home + 1]; ++k)
                        if (cells.particle[k] > i) partners.push_back(cells.particle[k]);
                }
        }
        std::sort(partners.begin(), partners.end());
        for (int j : partners) take_if_close(state, i, j, range, skin, found);
    }
    return found;
}

bool NeighbourList::update(const State& state, double range)
{
    if (covers(state, range)) return false;
    rebuild(state, range);
    return true;
}

void NeighbourList::rebuild(const State& state, double range)
{
    range_ = range;
    skin_ = state.radius.empty() ? 0 : skin_in_radii * largest_radius(state);
    reach_ = state.radius.empty() ? 0 : largest_radius(state) * (2 + range);
    candidates_ = close_pairs(state, range, skin_);
    reference_.box = state.box;
    reference_.position = state.position;
    reference_.radius = state.radius;
    reference_.strain = state.strain;
}

// A pair in range now had |d| <= (1 + |strain|)(reach + w_i + w_j) at the rebuild, w =
// displacements relative to the affine motion since then.
bool NeighbourList::covers(const State& state, double range) const
{
    if (range != range_ || state.radius != reference_.radius ||
        state.box.length != reference_.box.length)
        return false;
    const double strain = state.strain - reference_.strain;
    const double drift = state.box.offset - reference_.box.offset - strain * state.box.length.y();
    const double off = drift - std::round(drift / state.box.length.x()) * state.box.length.x();
    if (std::abs(off) > 1e-9 * state.box.length.x()) return false;
    const Images images(state.box);
    double first = 0, second = 0;  // the two largest squared displacements
    for (int i = 0; i < state.size(); ++i) {
        Vec3 moved = reference_.position[i];
        moved.x() += strain * moved.y();
        const double w = images.separation(moved, state.position[i]).d.squaredNorm();
        if (w > first) {
            second = first;
            first = w;
        } else if (w > second) {
            second = w;
        }
    }
    const double now = reach_ + std::sqrt(first) + std::sqrt(second);
    return (1 + std::abs(strain)) * now <= reach_ + skin_;
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
        if (xi < range)
            pairs.push_back(
                {i, j, sep.image, sep.d, sep.d / r, r, r - sum, xi});
    }
}

std::vector<Pair> find_pairs(const State& state, double range, const NeighbourList& list)
{
    std::vector<Pair> pairs;
    find_pairs(state, range, list, pairs);
    return pairs;
}

}
