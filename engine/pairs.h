// engine/pairs.h -- neighbours across the sheared boundary, at a cost proportional to n.
//
// NeighbourList holds the pairs i < j that lie, or may soon lie, within the interaction range:
// those with centre distance below range + skin at the positions of its last rebuild. Between
// rebuilds the particles may move; `update` knows from the largest non-affine displacements and the
// strain whether a pair could have come into range unseen, and rebuilds then, with a skin that
// follows from how fast the last one was used up. Candidates are sorted by (i, j).
//
// find_pairs: the candidates in range (xi < range), with nearest images, sorted by (i, j).
// Cell list: Allen & Tildesley, Computer Simulation of Liquids (1987), section 5.3; sheared
// boundary: Lees & Edwards, J. Phys. C 5, 1921 (1972). Tested against all pairs.
#pragma once
#include "engine/state.h"
#include "engine/types.h"

#include <vector>

namespace sigmaflow {

struct Pair {
    int i, j;         // i < j
    int image;        // the image of j moves with U_j + image * shear_rate * Ly e_x
    Vec3 separation;  // from i to the image of j [a]
    Vec3 normal;
    double distance, gap;  // [a]
    double xi;             // 2 gap/(a_i + a_j) [-]

    bool touching() const { return xi <= 0; }
};

template <class Archive>
void archive(Archive& a, Pair& p)
{
    a(p.i, p.j, p.image, p.separation, p.normal, p.distance, p.gap, p.xi);
}

struct Candidate {
    int i, j;
    using stored_as_bytes = void;
    bool operator==(const Candidate&) const = default;
};

/// Cells of at least the reach in y and z, and in x; the particles cell by cell.
struct Cells {
    int nx = 0, ny = 0, nz = 0;
    std::vector<int> start, particle;
    std::vector<double> x, y, z, radius;  // of the particles in this order
    std::vector<int> home, next;          // while they are sorted
    std::vector<Vec3> wrapped;

    int index(int cx, int cy, int cz) const { return (cz * ny + cy) * nx + cx; }
};

/// What the search for close pairs keeps from one time to the next; one part for each thread.
struct PairSearch {
    struct Part {
        std::vector<Candidate> found;
        std::vector<double> excess;
        std::vector<int> partners;
    };
    Cells cells;
    std::vector<Part> parts;
};

class NeighbourList {
public:
    /// Makes the list valid for this state and range in xi. Returns true if it was rebuilt.
    bool update(const State& state, double range, int threads = 1);

    const std::vector<Candidate>& candidates() const { return candidates_; }

    /// How the skin was used since the last rebuild: the next skin follows from it.
    struct Use {
        double used = 0;  // of the skin, at the last update [a]
        int updates = 0;
    };
    const Use& use() const { return use_; }
    void set_use(const Use& use) { use_ = use; }

    bool empty() const { return range_ < 0; }
    /// Positions, box and strain at the last rebuild; no contacts.
    const State& reference() const { return reference_; }
    /// All but the candidates, which find_again() finds from the rest.
    template <class Archive>
    void archive(Archive& a)
    {
        a(reference_, range_, skin_, use_.used, use_.updates);
    }
    /// Errors: input (not the list of this state).
    void find_again(const State& state, int threads);

private:
    bool covers(const State& state, double range, int threads);
    void rebuild(const State& state, double range, int threads);

    std::vector<Candidate> candidates_;
    PairSearch search_;
    State reference_;
    double range_ = -1;  // in xi
    double reach_ = 0;   // largest centre distance of interest [a]
    double skin_ = 0;    // [a]
    Use use_;
};

/// For candidates that come from a file. Error(input) unless they are sorted pairs i < j < n.
void check_candidates(const std::vector<Candidate>& candidates, int n);

/// All pairs i < j closer than `cutoff(a_i + a_j)` = (a_i + a_j)(1 + range/2) + skin, sorted.
std::vector<Candidate> close_pairs(const State& state, double range, double skin);
void close_pairs(const State& state, double range, double skin, int threads, PairSearch& search,
                 std::vector<Candidate>& found);

/// Replaces the content of `pairs`.
void find_pairs(const State& state, double range, const NeighbourList& list,
                std::vector<Pair>& pairs);
std::vector<Pair> find_pairs(const State& state, double range, const NeighbourList& list);

}
