// engine/memory.h -- what a workspace remembers, as bytes: for runs that go on exactly.
//
// The next step depends on the state and, by its last bits, on what the workspace keeps from
// earlier steps: the guesses for the solver, the motion over the last implicit step, the age of the
// neighbour list (with it the order of all sums) and of the preconditioner. With both restored a
// run goes on bit by bit as if it had never stopped, with any number of threads (tested for every
// scheme, control and solver). What can be computed again from the rest is not stored.
// Errors: input (bytes that no workspace has written, or of another state).
#pragma once
#include "engine/archive.h"
#include "engine/evaluation.h"

namespace sigmaflow {

/// `state`: the one the last step led to.
void save_memory(const State& state, Workspace& workspace, ArchiveWriter& archive);

/// Into a fresh workspace with the same solver settings.
void restore_memory(const State& state, const Model& model, Workspace& workspace,
                    ArchiveReader& archive);

}
