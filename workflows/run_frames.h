// workflows/run_frames.h -- the frames in the folder of a run, whatever has become of it: those of
// run.h5 where the step is finished, otherwise those that its journal has so far.
//
// Nothing is changed and no lock is taken. Errors: usage (no such step), input (nothing stored yet,
// damaged files), missing.
#pragma once
#include "engine/frame.h"
#include "engine/model.h"
#include "workflows/past_run.h"

#include <string>
#include <vector>

namespace sigmaflow::workflows {

struct RunFrames {
    std::vector<Frame> list;
    Control control;
};

/// The named step, or the last step "shear" that has stored frames (any step that shears, if no
/// "shear" has).
const PastStep& step_with_frames(const PastRun& run, const std::string& of);

/// At least one frame. Takes all of them into memory.
RunFrames read_frames(const PastRun& run, const PastStep& step);

}
