// engine/slices.h -- the order in which the hot loops meet particles and pairs.
//
// Particles that may interact get different colours (greedy colouring of the graph of candidate
// pairs); those of one colour are independent of each other and are cut into slices of eight, one
// particle a lane. Elimination, sweeps of the preconditioner and sums over pairs then work on eight
// particles at once, and the slices of a colour may be divided among threads. (Multicolour
// ordering: Saad, Iterative Methods for Sparse Linear Systems, 2003, section 12.4; sliced storage:
// Monakov, Lokhmotov, Avetisyan, HiPEAC 2010.)
//
// Every pair is stored once, in the slice of its particle of the earlier colour (`first`): upper
// groups of eight pairs, lane by lane; the later particle (`second`) meets it again through the
// lower groups. Unused lanes point to the pair `pairs()` and the slot `slots()`, which exist and
// are zero.
#pragma once
#include "engine/lanes.h"
#include "engine/pairs.h"

#include <array>
#include <vector>

namespace sigmaflow {

struct Slices {
    int particles = 0;
    int count = 0;                     // slices
    std::vector<int> colour;           // [colours + 1] first slice of each colour
    std::vector<int> slot;             // [particles]
    std::vector<int> particle;         // [slots]; -1: unused
    std::vector<int> upper;            // [count + 1] first upper group of each slice
    std::vector<int> first, second;    // [pairs] slots
    std::vector<int> lower;            // [count + 1] first lower group of each slice
    std::vector<int> lower_pair;       // [lower groups * lanes] pair
    std::vector<int> lower_slot;       // [lower groups * lanes] slot of its first particle
    std::vector<int> pair_of;          // [candidates] pair
    std::vector<signed char> flipped;  // [candidates] 1: the first particle of the pair is j

    int slots() const { return count * lanes; }
    int groups() const { return count > 0 ? upper[count] : 0; }
    int pairs() const { return groups() * lanes; }
};

/// Makes slices and keeps the memory that this takes.
class SliceMaker {
public:
    /// For the particles of a state, whose positions order them in space within a colour;
    /// `candidates` sorted by (i, j).
    void make(const State& state, const std::vector<Candidate>& candidates, Slices& slices);

private:
    /// Neighbours of every particle, and which candidate each is.
    struct Graph {
        std::vector<int> start, next, neighbour, candidate;
    };
    using Entry = std::array<int, 2>;  // slot of the other particle, candidate

    void connect(int particles, const std::vector<Candidate>& candidates);
    void order_in_space(const State& state);
    int find_colours();
    void find_neighbours(const Slices& slices, int slice, bool later);

    Graph graph_;
    std::vector<int> order_, colour_, used_by_, rank_, sorted_;
    std::vector<std::array<int, 2>> degree_;       // earlier and later neighbours
    std::array<std::vector<Entry>, lanes> lists_;  // of the lanes of one slice
};

/// Six numbers per particle, (U, Omega) or (F, T), in the order of the slices [count + 1]; the last
/// slice is zero.
struct alignas(64) Slice6 {
    d8 c[6];
    using stored_as_bytes = void;
};
using SlicedVector = std::vector<Slice6>;

/// Velocity, then angular velocity (or force, then torque) of every particle [n].
using Velocities = std::vector<Vec6>;

void to_slices(const Velocities& v, const Slices& slices, SlicedVector& result, int threads = 1);
void from_slices(const SlicedVector& v, const Slices& slices, Velocities& result, int threads = 1);

double dot(const SlicedVector& u, const SlicedVector& v);

}
