// engine/workspace.h -- what evaluations share inside the engine: geometry, forces, matrix,
// buffers.
#pragma once
#include "engine/evaluation.h"
#include "engine/pair_table.h"
#include "engine/slices.h"

#include <array>
#include <vector>

namespace sigmaflow {

/// Solutions at the last two different times, for a guess linear in time.
struct SolutionHistory {
    int known = 0;
    std::array<double, 2> time{}, rate{};  // newest first
    std::array<Velocities, 2> solution;

    /// Leaves v empty if nothing is known of as many particles; returns the shear rate.
    double guess(double at, int particles, int threads, Velocities& v) const;
    void remember(double at, const Velocities& v, double shear_rate);
};

template <class Archive>
void archive(Archive& a, SolutionHistory& h)
{
    a(h.known, h.time, h.rate, h.solution);
}

/// Mean motion over an implicit step, as seen from its end: the next step leans on it.
struct PastStep {
    double time = -1, dt = 0;  // at its end; its length
    Evaluation mean;           // nonaffine, shear_rate, contacts, motion
};

template <class Archive>
void archive(Archive& a, PastStep& p)
{
    a(p.time, p.dt, p.mean.nonaffine, p.mean.shear_rate, p.mean.contacts, p.mean.motion);
}

/// Rows of eight doubles, aligned.
struct alignas(64) Row {
    double v[8];
};

struct Workspace::Buffers {
    explicit Buffers(const SolverSettings& settings)
        : solver(settings), tolerance(settings.tolerance), threads(settings.threads)
    {
    }

    NeighbourList neighbours;
    SliceMaker slice_maker;
    Slices slices;
    PairTable table;
    ResistanceMatrix matrix;
    ResistanceSolver solver;
    double tolerance;
    int threads;

    // the configuration whose geometry the table holds
    std::vector<Vec3> position;
    std::vector<double> radius;
    Box box;
    double range = -1;
    bool located = false;
    std::vector<int> touching;                     // candidates, ascending
    std::vector<Pair> touching_pairs;              // i < j
    std::vector<std::vector<int>> touching_parts;  // while they are found, by thread

    std::vector<int> memory;  // contact of the state for each touching pair, or -1
    double* row_values() { return rows.data()->v; }
    std::vector<Row> rows;               // of positions or velocities, one a slot
    std::vector<D8> moment, affine;      // partial sums of the slices
    SlicedVector unit_load, fixed_load;  // per unit rate, rate free
    SlicedVector right, solution, other_solution;
    Velocities guess, foreseen, hydrodynamic;  // the last one: R_FU^-1 f of the last sample
    std::vector<ContactMotion> foreseen_motion;
    std::vector<Evaluation> spare;  // of earlier steps: their memory is used again
    std::array<State, 2> moved;     // stages of a step
    State trial;                    // of a step that may be undone
    SolutionHistory history;
    std::array<PastStep, 2> past;        // implicit steps: the last one, and one before or undone
    std::vector<double> friction_share;  // of the touching pairs after the last move
};

bool uses_dashpot(const Model& model);

/// Largest xi at which anything acts.
double interaction_range(const Model& model);

/// Neighbours, geometry and touching pairs of a state: nothing if they are known.
void locate(const State& state, const Model& model, Workspace::Buffers& buffers);

/// Slices, shapes and patterns for the neighbours in the buffers, which were found for `state`.
void make_pattern(const State& state, Workspace::Buffers& buffers);

/// Geometry, forces and resistance matrix of a state, in the buffers; contact forces also in the
/// result. Springs act over the time `ahead` if there is one (implicit stages).
Evaluation prepare(const State& state, const Model& model, const Control& control,
                   const ImplicitStage* stage, Workspace::Buffers& buffers);

/// The load of a dashpot in the ambient flow, per unit shear rate.
lubrication::PairLoad dashpot_unit_load(const State& state, const PairState& pair);

void add(Velocities& loads, const Pair& pair, const lubrication::PairLoad& load);

/// In the limit of vanishing drag the forces balance only if sum a_i V_i = 0.
void remove_drift(const State& state, Velocities& v);

/// Volume times the shear stress of the solvent per unit shear rate.
double solvent_resistance(const State& state, const Model& model);

/// Loads of the force balance (unit_load and fixed_load of the buffers) and what the shear stress
/// needs.
struct Loads {
    double affine = 0;        // V eta_s + Ehat:R_SE:Ehat
    double first_moment = 0;  // sum of sym(d, F)_xy of contacts and repulsion
};
Loads assemble_loads(const State& state, const Evaluation& evaluation, Workspace::Buffers& buffers);

/// One solve: at an imposed rate, or by the rank-one form of stress control. `share` of the
/// tolerance.
void solve_at_once(const State& state, const Loads& loads, SolutionHistory& history,
                   Workspace::Buffers& buffers, Evaluation& evaluation, double share = 1);

/// Sets the slip velocities of the contacts; throws if a velocity is not finite.
void complete(const State& state, int threads, Evaluation& evaluation);

}
