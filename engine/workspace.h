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
    std::vector<BlockCoefficients> coefficients;  // one per candidate
    ResistanceSolver solver;
    ResistanceMatrix matrix;
    SolutionHistory history;
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

/// Sets the slip velocities of the contacts; throws if a velocity is not finite.
void complete(const State& state, Evaluation& evaluation);

}
