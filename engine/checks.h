// engine/checks.h -- values that no computation can go on from, found cheaply and named.
//
// Every check is a pass over the numbers; the culprit is looked for only when one failed. Errors:
// numerics, with the quantity and the particle or pair: "the position of particle 12 is not
// finite".
//
// Limits: positions and box offset at most 1e6 box lengths from the box (beyond, the images lose
// their digits); radii and box lengths > 0; contacts i < j, sorted; overlaps xi >= deepest_overlap.
// Spheres of the default model overlap by up to 0.04 under any stress, those of a tenth of its
// stiffness by 0.06 [measured: README.md]; where they pass the limit, the linear spring
// of the contact means nothing, and the step or the stiffness is wrong.
#pragma once
#include "engine/forces/contact.h"
#include "engine/model.h"
#include "engine/pairs.h"
#include "engine/state.h"

#include <cstddef>
#include <vector>

namespace sigmaflow {

inline constexpr double deepest_overlap = -0.3;  // xi

/// Whether all values are numbers of at most this size (but for rounding).
bool all_within(const double* values, std::size_t count, double limit);
bool all_finite(const double* values, std::size_t count);

/// "<name> is not finite"
void check_scalar(double value, const char* name);

/// Box, positions and radii.
void check_geometry(const State& state);

/// Strain, time and time step.
void check_clock(const State& state);

/// Geometry, clock and contacts.
void check_state(const State& state);

/// Whether the springs of a contact are; the first contact of which they are not.
bool is_finite(const Contact& contact);
[[noreturn]] void refuse_springs(const std::vector<Contact>& contacts);

/// The forces and torques of all contacts.
void check_forces(const std::vector<ContactLoad>& contacts);

/// All numbers of the model and what is imposed.
void check_model(const Model& model, const Control& control);

/// Refuses the pair that overlaps most, if it passes the limit: "particles 3 and 12 overlap by 0.45
/// of their mean radius, the limit is 0.3".
void check_overlaps(const std::vector<Pair>& pairs);

}
