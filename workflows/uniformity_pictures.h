// workflows/uniformity_pictures.h -- what the step "uniformity" draws.
#pragma once
#include "workflows/measured_fields.h"
#include "workflows/pictures.h"

namespace sigmaflow::workflows {

struct PictureContext {
    PictureSize size;
    std::string title;
};

/// u - y with its standard error, the fit of two bands if there are some, and the bands of the
/// smallest contrast that would have been seen.
render::Plot residual_plot(const PictureContext& pictures, const MeasuredField& velocity,
                           const UniformityTest& rate_test);

/// All fields across one axis but the velocity and the rate, over their means, with errors.
render::Plot fields_plot(const PictureContext& pictures, const std::vector<MeasuredField>& fields,
                         Axis axis);

/// At most 400 frames, evenly chosen.
std::vector<const Frame*> thinned(const std::vector<Frame>& frames);

/// A field as colour over strain and position: its mean over a quarter of the box around each
/// place. Two frames or more.
render::Plot space_time_plot(const PictureContext& pictures,
                             const std::vector<const Frame*>& frames, const MeasuredField& field);

}
