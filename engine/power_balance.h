// engine/power_balance.h -- the power put in at the boundary against what is stored and dissipated.
//
// Exact at every instant, without inertia [eta0 rate0^2 a^3]:
//   stress rate V = solvent + drag + lubrication + dashpots + contacts + repulsion + torque
//   residual solvent      V eta_s rate^2 drag         sum_i 6 pi a_i |U - U_inf|^2 + 8 pi a_i^3
//   |Omega - w_inf|^2 lubrication  V.R_lub.V - 2 rate V.R_FE:Ehat + rate^2 Ehat:R_SE:Ehat, >= 0
//   dashpots, contacts, repulsion: -(F_i.U_i + F_j.U_j + T_i.Omega_i + T_j.Omega_j) of each pair
//   torque residual  torques use radii, not lever arms: w_inf.(T_i + T_j - d x F_i)
// Contacts split, with N the load, t the spring of stiffness kt abar, v_t the slip velocity:
//   normal springs      N times the closing speed, the change of kn abar h^2/2
//   tangential springs  the change of kt abar t^2/2: F_t.v_t where the contact sticks; where it is
//   at
//                       its limit mu N_f, at most |F_t| mu (dN/dt)/(kt abar), by which the limit
//                       grows
//   sliding friction    the rest of F_t.v_t, >= 0;   rolling springs likewise
// Tests: the sum, springs' energies along a trajectory, sliding blocks.
#pragma once
#include "engine/evaluation.h"

#include <span>
#include <string_view>

namespace sigmaflow {

/// Exact balance of the mechanical power: input = sum of all other terms [eta0 rate0^2 a^3].
struct PowerBalance {
    double input = 0, solvent = 0, drag = 0, torque_residual = 0, lubrication = 0, dashpot = 0,
           contact = 0, repulsion = 0;
};
PowerBalance power_balance(const State& state, const DetailedEvaluation& detailed);

/// The power of the contacts by where it goes.
struct ContactPower {
    double normal_springs = 0;      // stored
    double tangential_springs = 0;  // stored, rolling springs included
    double sliding = 0;             // dissipated, rolling friction included; >= 0
};
ContactPower contact_power(const State& state, const Evaluation& evaluation);

/// All of it; `input` from the imposed stress where one is imposed, so that the residual contains
/// the error of the stress, too.
struct Power {
    double strain = 0, shear_rate = 0;
    double input = 0;
    double solvent = 0, lubrication = 0, drag = 0, dashpots = 0, sliding = 0;  // dissipated, >= 0
    double normal_springs = 0, tangential_springs = 0, repulsion = 0;  // stored, either sign
    double torque_residual = 0;
    double residual = 0;  // (input - sum of the others)/(largest of all) [-]
};

/// Errors: those of evaluate_in_detail.
Power evaluate_power(const State& state, const Model& model, const Control& control,
                     Workspace& workspace);

struct PowerField {
    std::string_view name, meaning;
    double Power::*value;
    bool stored;  // otherwise dissipated
};

/// Where the input goes: the only list of the terms, which add up to the input.
std::span<const PowerField> power_fields();

}
