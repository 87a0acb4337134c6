// workflows/particle_colours.h -- how pictures and films of particles are coloured.
#pragma once
#include "render/particles.h"
#include "workflows/pictures.h"
#include "workflows/step.h"

namespace sigmaflow::workflows {

struct ParticleColours {
    std::string colour_by = "nonaffine_speed", colour_map = "inferno";
    std::optional<double> colour_maximum;

    void describe(io::Fields& f);
    /// The view of a frame, its title included.
    render::ParticleView view(const Run& run, const Frame& frame, const PictureSize& size) const;
    bool shows_chains() const { return colour_by == "normal_force"; }
    render::Image draw(const Frame& frame, const render::ParticleView& view,
                       render::KeptWindow* window = nullptr) const;
};

}
