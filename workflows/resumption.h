// workflows/resumption.h -- what of an earlier run in the folder can be used again, and why not.
//
// A finished step is used again while everything it depends on is unchanged (StepIdentity::key) and
// its files are what they were. An interrupted step goes on from its checkpoint; if its parameters,
// or a step before it, were changed in between, the run is refused by name rather than the work
// thrown away. Another suspension or model in the same folder is refused, too. `force` throws all
// earlier work away.
// Errors: input (refused, with old and new values), missing (no usable checkpoint).
#pragma once
#include "workflows/checkpoint.h"
#include "workflows/step_record.h"

#include <optional>
#include <string>
#include <vector>

namespace sigmaflow::workflows {

struct PlannedStep {
    StepIdentity identity;
    std::optional<StepRecord> record;  // finished earlier
    std::string reason;                // why it runs although there was a record, or ""
};

struct Resumption {
    std::vector<PlannedStep> steps;        // one for each step of the workflow
    std::optional<Checkpoint> checkpoint;  // of a step without record
    std::vector<std::string> warnings;
};

Resumption plan_resumption(const Workflow& workflow, const RunFolder& folder, bool force);

/// Removes what the plan does not use: records, files and checkpoints of an earlier run.
void remove_unused(const Resumption& plan, const RunFolder& folder);

}
