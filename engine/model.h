// engine/model.h -- the physical parameters of the model and what is imposed on it.
//
// Names are those of the workflow files, of the case files and of HDF5 attributes. Source of the
// model: Mari, Seto, Morris, Denn, Phys. Rev. E 91, 052302 (2015); details in engine/README.md.
#pragma once
#include "engine/units.h"

#include <variant>

namespace sigmaflow {

enum class ContactHydrodynamics { lubrication, dashpot };
enum class StiffnessScale { stress, fixed };
enum class RepulsionAmplitude { reduced_radius, derjaguin, constant };

struct Model {
    double lubrication_delta = 1e-3;  // regularisation of the gap [-] > 0
    double lubrication_range = 0.5;   // pairs with xi below it [-] > 0
    ContactHydrodynamics contact_hydrodynamics = ContactHydrodynamics::lubrication;
    double contact_relaxation_time = 0;                    // [1/rate0] >= 0; 0: coefficient 1/delta
    double normal_stiffness = 2000 / reference_force;      // [F*/a] >= 0
    double tangential_stiffness = 1000 / reference_force;  // [F*/a] >= 0
    StiffnessScale stiffness_scale = StiffnessScale::stress;  // stress: times sigma/sigma0
    double friction_static = 1;                               // [-] >= friction_dynamic
    double friction_dynamic = 1;                              // [-] >= 0
    double critical_load = 0;                                 // [F*] >= 0
    double rolling_stiffness = 0;                             // [F*/a] >= 0, scaled like the others
    double rolling_friction = 0;                              // [-] >= 0
    double repulsion = 1;                                     // [F*] >= 0
    double debye_length = 0.02;                               // [a] > 0
    RepulsionAmplitude repulsion_amplitude = RepulsionAmplitude::reduced_radius;
    double repulsion_range = 0.5;  // pairs with xi below it [-] > 0
    bool einstein = true;          // 5/2 phi in the solvent stress
    double drag_factor = 1;        // zeta [-] > 0
    bool background_drag = true;   // false: the limit zeta -> 0
};

struct ImposedStress {
    double value = 1;  // sigma/sigma0
};
struct ImposedRate {
    double value = 1;  // shear_rate/rate0
};
using Control = std::variant<ImposedStress, ImposedRate>;

template <class Archive>
void archive(Archive& a, ImposedStress& stress)
{
    a(stress.value);
}
template <class Archive>
void archive(Archive& a, ImposedRate& rate)
{
    a(rate.value);
}

/// Spring constants in force in F*/a after the stiffness rule.
struct Stiffness {
    double normal, tangential, rolling;
};

/// Throws Error(input) for the scale `stress` under an imposed rate.
Stiffness stiffness(const Model& model, const Control& control);

}
