// workflows/particle_picture.h -- a frame as a picture: the parameters that all pictures of
// particles share, and the one place that draws them.
//
// Used by the steps `snapshot` and `movie` and by `sigmaflow render`.
#pragma once
#include "engine/frame.h"
#include "io/json_fields.h"
#include "render/particles.h"
#include "workflows/pictures.h"

#include <optional>
#include <string>
#include <vector>

namespace sigmaflow::workflows {

struct ParticlePicture {
    std::string colour_by = "nonaffine_speed", colour_map = "inferno";
    std::optional<double> colour_maximum;
    std::string viewed_from = "oblique";
    std::optional<double> azimuth, elevation;  // replace those of the view
    double zoom = 1;
    std::string clip;
    PictureSize size;

    void describe(io::Fields& f);
    /// What is more than the range of one parameter. Errors: input.
    void validate(const io::JsonNode& node) const;

    /// What is drawn; the title says that it is clipped.
    render::ParticleView particle_view(const Frame& frame, std::string title) const;
    /// One view for several frames, each with its own title: neither camera nor colours jump.
    render::ParticleView common_view(const std::vector<Frame>& frames) const;
    render::Image draw(const Frame& frame, const render::ParticleView& view,
                       render::KeptWindow* window = nullptr) const;
};

/// "z=5", "y = 3.5:below": hides the centres above or below; above if it is not said. Nothing if it
/// is none.
std::optional<render::ClipPlane> clip_plane(const std::string& text);

bool hides_all(const render::ClipPlane& plane, const Frame& frame);

/// "phi = 0.56, sigma/sigma0 = 2, n = 200, gamma = 2.5" in Greek letters.
std::string frame_title(const Frame& frame, double volume_fraction, const Control& control);

/// The one that is nearest to the strain. At least one frame.
std::size_t nearest_frame(const std::vector<Frame>& frames, double strain);

}
