// workflows/wyart_cates_pictures.h -- the measured curves and the model fitted to them, as the
// sketch in Fig. 1 of Mari et al. (Phys. Rev. E 91, 052302, 2015) and as a map of flow states.
#pragma once
#include "engine/wyart_cates.h"
#include "workflows/measured_curves.h"
#include "workflows/pictures.h"

namespace sigmaflow::workflows {

/// True if the point has a place on logarithmic axes.
bool flows(const Measured& m);

/// Stress against rate. Fitted curves are dashed where the rate falls; shaded are the states in
/// which it falls, and those of suspensions that jam at a higher stress. Jammed points stand at the
/// left edge.
render::Plot sketch_plot(const Curves& curves, const WyartCates& model, const PictureSize& size);

/// Stress against volume fraction: where the rate falls and where nothing flows, with the jamming
/// fraction of each of `drawn` models between dotted lines.
render::Plot state_map_plot(const Curves& curves, const WyartCates& model,
                            const std::vector<WyartCates>& drawn, double confidence,
                            const PictureSize& size);

}
