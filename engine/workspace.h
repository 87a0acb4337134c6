// engine/workspace.h -- what evaluations share inside the engine: geometry, forces, matrix,
// buffers.
#pragma once
#include "engine/evaluation.h"

#include <array>
#include <vector>

namespace sigmaflow {

/// Coefficients of a pair that R_FU needs, at L = l = 1 (pair_resistance.h).
struct BlockCoefficients {
    double xa, ya, yb11, yb21, yc11, yc12, yc22;
};

/// Solutions at the last two different times, for a guess linear in time.
struct SolutionHistory {
    int known = 0;
    std::array<double, 2> time{};  // newest first
    std::array<Velocities, 2> solution;

    Velocities guess(double at) const;
    void remember(double at, const Velocities& v);
};

struct Workspace::Buffers {
    explicit Buffers(const SolverSettings& settings) : solver(settings) {}

    NeighbourList neighbours;
    std::vector<Pair> pairs;
    std::vector<BlockCoefficients> coefficients;  // one per candidate
    ResistanceSolver solver;
    std::vector<Evaluation> spare;  // of earlier steps: their memory is used again
    ResistanceMatrix matrix;
    std::array<SolutionHistory, 2> history;    // of both stages of a step
    double last_rate = 0;                      // of the last solution
    Velocities unit_load, fixed_load;          // per unit rate, rate free
    Velocities unit_velocity, fixed_velocity;  // of the dashpot variant
};

bool uses_dashpot(const Model& model);

/// Largest xi at which anything acts.
double interaction_range(const Model& model);

/// Pairs, contact forces and (in the buffers) the resistance matrix of a state; no velocities yet.
Evaluation prepare(const State& state, const Model& model, const Control& control,
                   Workspace::Buffers& buffers);

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

/// A pair in the affine flow of unit rate: its load and Ehat:R_SE:Ehat of the pair. With e = Ehat n
/// and s = a_i + a_j the load is s XA (n.e) n + s YA (e - (n.e) n), s YB e x n.
struct AffineLoad {
    lubrication::PairLoad load;
    double stress;
};
AffineLoad affine_load(const State& state, const Pair& pair, const BlockCoefficients& c);

/// One solve: at an imposed rate, or by the rank-one form of stress control.
void solve_at_once(const State& state, const Loads& loads, SolutionHistory& history,
                   Workspace::Buffers& buffers, Evaluation& evaluation);

/// Sets the slip velocities of the contacts; throws if a velocity is not finite.
void complete(const State& state, Evaluation& evaluation);

}
