// engine/motion.h -- moving box, particles and springs by velocities: what the schemes of step.h
// share.
//
// Everything moves with the same weighted rates. The positions of a stage within a step are not
// wrapped, so that all stages see the same images.
#pragma once
#include "engine/evaluation.h"
#include "engine/workspace.h"

#include <span>

namespace sigmaflow {

/// Motion that acts for the time dt (negative when the box goes back): V and shear rate at the
/// positions of a state, and the relative motion of contacts, sorted by (i, j).
struct Stage {
    const Velocities& nonaffine;
    double shear_rate;
    const std::vector<ContactLoad>& contacts;
    const std::vector<ContactMotion>& motion;
    const State& state;
    double dt;
};

inline Stage stage_of(const Evaluation& e, const State& state, double dt)
{
    return {e.nonaffine, e.shear_rate, e.contacts, e.motion, state, dt};
}

/// Particles, box, strain and time of `start` moved by the stages, not wrapped; its contacts.
void shift(const State& start, std::span<const Stage> stages, int threads, State& result);

/// Springs of the pairs that touch at the positions of `moved`: those of the first stage carried to
/// the new contact plane by the smallest rotation, stretched by the slip of all stages, projected
/// and limited by the friction law. At most two stages. Sets friction_share of the buffers; `mean`,
/// if given, gets the contacts and their mean slip over the step.
void move_contacts(std::span<const Stage> stages, const Model& model, const Control& control,
                   State& moved, Workspace::Buffers& buffers, Evaluation* mean = nullptr);

}
