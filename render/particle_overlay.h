// render/particle_overlay.h -- what stands around the particles: title, colour bar, axis triad.
#pragma once
#include "render/drawing.h"
#include "render/fonts.h"
#include "render/framing.h"
#include "render/ticks.h"

#include <string>

namespace sigmaflow::render {

/// The colours of a picture and what they mean.
struct ColourScale {
    std::string map;
    Range range{0, 1};
    bool whole_numbers = false;
    bool values_below = false, values_above = false;  // some values lie outside the range
    std::string label;                                // rich text

    Colour colour(double value) const;
};

/// A round range from 0 (or from the 1 % quantile where values are negative) to the 99 % quantile.
Range colour_range(std::vector<double> values, bool whole_numbers);

/// The usual label of a particle array, with its unit in the units of the paper.
std::string array_label(const std::string& array);

/// Sizes of a picture's parts, in pixels.
struct ParticleLayout {
    double unit = 1;  // scales the sizes that are given for a picture 1080 pixels high
    Rectangle particles, colour_bar, triad;
    Point title;
    double title_room = 0;
};
ParticleLayout particle_layout(int width, int height, bool title, bool colour_bar, bool triad);

void draw_colour_bar(Drawing& drawing, const Fonts& fonts, const ColourScale& scale,
                     const ParticleLayout& layout);
/// An axis that points at the viewer is a dot, one that points away a cross, both in a circle.
void draw_triad(Drawing& drawing, const Fonts& fonts, const ParticleLayout& layout,
                const ViewAxes& axes = view_axes());
void draw_title(Drawing& drawing, const Fonts& fonts, const std::string& title,
                const ParticleLayout& layout);

}
