// engine/evaluation.h -- velocities, shear rate and stress of a state under an imposed stress or
// rate.
//
// Solves  R_FU V = F_C + F_R + rate R_FE:Ehat [+ rate F_dash]  and finds the rate that makes the
// shear stress the imposed one (Mari et al., Phys. Rev. E 91, 052302, 2015, eqs. 1-4). V is the
// velocity relative to the ambient flow (non-affine). Everything is a function of the state.
//
// evaluate: velocities and rate alone, for stepping, in one solve. With f = R_FE:Ehat, C0 = V eta_s
// +
//   Ehat:R_SE:Ehat and S_F the shear part of the first moments of the rate-free forces, reciprocity
//   (R_SU = R_FE^T) turns eq. 3 into rate = (sigma V - S_F + f.V)/C0, hence
//   (R_FU - f f^T/C0) V = F_C + F_R + f (sigma V - S_F)/C0,
//   symmetric positive definite because the dissipation is positive. The dashpot variant, whose
//   torques break the reciprocity slightly, takes two solves.
// evaluate_in_detail: as in the paper, one factorisation, one solution per force, and every
// component
//   of the stress: rate = (sigma - S_fixed,xy)/S_unit,xy, S = rate S_unit + S_fixed.
// Tested: both agree, S_xy equals the imposed stress, power balance (power_balance.h), image and
// label invariance, and 22 configurations with known answers.
#pragma once
#include "engine/forces/contact.h"
#include "engine/frame.h"
#include "engine/lubrication/pair_resistance.h"
#include "engine/model.h"
#include "engine/pairs.h"
#include "engine/solver.h"
#include "engine/state.h"
#include "engine/types.h"

#include <array>
#include <memory>
#include <string_view>
#include <vector>

namespace sigmaflow {

/// A pair in range with all that acts in it.
struct PairState {
    Pair pair;
    lubrication::GapFactors factors{0, 0};  // zero beyond the lubrication range
    double repulsion = 0;                   // [eta0 rate0 a^2]
    int contact = -1;      // index into the contacts of the evaluation, if the pair touches
    bool dashpot = false;  // touching, with the A, B, C block on the total velocities
};

/// Relative motion of the surfaces of a pair.
struct ContactMotion {
    Vec3 slip, roll;  // tangential surface velocity, rolling velocity [a rate0]
};

template <class Archive>
void archive(Archive& a, ContactMotion& m)
{
    a(m.slip, m.roll);
}

struct Evaluation {
    Model model;
    Control control;
    double shear_rate = 0;
    std::vector<PairState> pairs;       // in range, sorted by (i, j); of detailed evaluations only
    std::vector<ContactLoad> contacts;  // touching pairs, sorted by (i, j)
    std::vector<ContactMotion> motion;  // one per contact
    Velocities nonaffine;               // V = (U - U_inf, Omega - w_inf)
    SolveReport solve;
};

/// Right-hand sides of the force balance; hydro and dashpot are per unit shear rate.
enum Column { column_hydro, column_dashpot, column_contact, column_repulsion };
inline constexpr std::array<std::string_view, 4> column_names{"hydro", "dashpot", "contact",
                                                              "repulsion"};

/// Parts of the stress; xF: first moment of a pair force, RSU, RSE: stresslets.
enum StressPart {
    solvent,
    hydro_RSE,
    hydro_RSU,
    dashpot_RSU,
    dashpot_xF,
    contact_xF,
    contact_RSU,
    repulsion_xF,
    repulsion_RSU
};
inline constexpr std::array<std::string_view, 9> stress_part_names{
    "solvent",    "hydro_RSE",   "hydro_RSU",    "dashpot_RSU",  "dashpot_xF",
    "contact_xF", "contact_RSU", "repulsion_xF", "repulsion_RSU"};
using StressParts = std::array<Mat3, stress_part_names.size()>;

struct DetailedEvaluation {
    Evaluation evaluation;
    std::array<Velocities, column_names.size()> column;  // relative to the ambient flow
    StressParts stress;  // at the shear rate; they add up to the total

    Mat3 total_stress() const;
};

/// Buffers, neighbour list and solvers that are kept between evaluations: nothing that changes a
/// result beyond the tolerance of the solver. One per thread.
class Workspace {
public:
    explicit Workspace(const SolverSettings& solver = {});
    ~Workspace();
    Workspace(Workspace&&) noexcept;
    Workspace& operator=(Workspace&&) noexcept;

    struct Buffers;
    Buffers& buffers() { return *buffers_; }

private:
    std::unique_ptr<Buffers> buffers_;
};

/// Errors: input (stiffness rule against control), numerics (resistance matrix not positive
/// definite, coinciding particles, a value that is not finite).
Evaluation evaluate(const State& state, const Model& model, const Control& control,
                    Workspace& workspace);

/// What an implicit step (step.h) adds to the force balance of its predicted end. Contact springs
/// and repulsion are taken where the velocities found bring them, not where the predicted ones did:
/// each pair resists the difference with `ahead` times its stiffness.
struct ImplicitStage {
    double ahead = 0;                       // time for which the velocities act [1/rate0] > 0
    const Velocities* predicted = nullptr;  // V that led to the state
    double predicted_rate = 0;
    const std::vector<double>* share = nullptr;  // of each touching pair: its friction over that of
                                                 // a spring without limit [0, 1]
};

/// Velocities at the end of such a step. Errors: as evaluate, and input for the dashpot variant.
Evaluation evaluate_implicitly(const State& state, const Model& model, const Control& control,
                               const ImplicitStage& stage, Workspace& workspace);

/// Adds the pairs in range to an evaluation of the same state.
void list_pairs(const State& state, Evaluation& evaluation, Workspace& workspace);

DetailedEvaluation evaluate_in_detail(const State& state, const Model& model,
                                      const Control& control, Workspace& workspace);

/// Gives back the memory of an evaluation that is no longer needed, so that no step allocates.
void recycle(Evaluation&& evaluation, Workspace& workspace);

/// U and Omega at the positions of the state.
Velocities total_velocities(const State& state, const Evaluation& evaluation);

ContactMotion relative_motion(const State& state, const Evaluation& evaluation, const Pair& pair);

/// All resistance scalars of a pair in range.
lubrication::PairResistance resistance(const State& state, const PairState& pair);

/// S_i with 2 eta0 E_inf + sum S_i/volume = total stress; x F shared as a_i : a_j [sigma0 a^3].
std::vector<Mat3> particle_stress(const State& state, const DetailedEvaluation& detailed);

/// Forces on i in eta0 rate0 a^2: hydrodynamic (block and R_FE), dashpot, contact, repulsion.
struct PairForces {
    Vec3 lubrication, dashpot, contact, repulsion;
};
std::vector<PairForces> pair_forces(const State& state, const Evaluation& evaluation);

/// The stress as a sample has it: total, and the shear components by origin.
struct StressSummary {
    Mat3 total = Mat3::Zero();
    double solvent = 0, hydrodynamic = 0, contact = 0, repulsion = 0;
};

StressSummary summary_of(const DetailedEvaluation& detailed);

/// An evaluation with the stress, at a fraction of the cost of evaluate_in_detail and accurate to
/// 1e-7: one solution for the velocities and one for R_FU^-1 f, f = R_FE:Ehat. By reciprocity the
/// shear stress of the velocities that a force F drives is - F.R_FU^-1 f/V, so that no force needs
/// a solution of its own. The dashpot variant, which is not reciprocal, is evaluated in detail.
struct SampledEvaluation {
    Evaluation evaluation;
    StressSummary stress;
};
SampledEvaluation evaluate_sample(const State& state, const Model& model, const Control& control,
                                  Workspace& workspace);

Sample make_sample(const State& state, const SampledEvaluation& sampled);
Sample make_sample(const State& state, const DetailedEvaluation& detailed);
Frame make_frame(const State& state, const DetailedEvaluation& detailed);

}
