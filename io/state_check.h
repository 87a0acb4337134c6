// io/state_check.h -- is a configuration from a file one that the model can say something about?
//
// Refused, at the place in the file:
//   spheres that fill more than their box
//   a box narrower than the largest distance at which two spheres interact: a sphere would act on
//     its own images. (Each pair counts once, with its nearest image, so in boxes below twice that
//     distance, engine/box.h, the second image of a pair is left out.)
//   coinciding centres, and overlaps deeper than deepest_overlap (engine/checks.h)
#pragma once
#include "engine/state.h"
#include "io/json_document.h"

namespace sigmaflow::io {

/// `node` is what the state was read from, `range` the largest xi of an interaction. Error(input).
void check_state(const State& state, double range, const JsonNode& node);

}
