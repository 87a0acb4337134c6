// render/particles.h -- spheres at their true radii, coloured by one of their arrays.
//
// Takes the same vtkPolyData that is saved for ParaView (point arrays `radius` and the colour
// array), so picture and file cannot disagree. Vectors are coloured by their length; integer arrays
// get a bar of whole numbers. Colours run from 0 (from a round 1 % quantile where values are
// negative) to a round 99 % quantile; values beyond are marked on the bar.
// The viewer may stand anywhere around the box, and a plane can hide the particles (and contacts of
// particles) with centres beyond it; that changes no colour.
// Errors: rendering (no driver, no font), input (no such array, unknown colour map, empty colour
// range, positions not finite, radius <= 0, nothing left by the plane, zoom outside [0.1, 100]).
#pragma once
#include "render/framing.h"
#include "render/image.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

class vtkDataSetAttributes;
class vtkPolyData;

namespace sigmaflow::render {

/// Hides what has its centre above (or below) a value of x, y or z.
struct ClipPlane {
    int axis = 2;      // 0, 1, 2: x, y, z
    double value = 0;  // [a]
    bool hides_above = true;

    bool hides(const Position& centre) const
    {
        return hides_above ? centre[axis] > value : centre[axis] < value;
    }
};

struct ParticleView {
    int width = 1920, height = 1080;     // [64, 16384]
    std::array<double, 3> box_length{};  // outline [0, L]
    std::string colour_by = "nonaffine_speed";
    std::string colour_label;            // rich text; empty: made from colour_by
    std::string colour_map = "inferno";  // inferno, viridis, paper (dark grey to yellow)
    std::optional<double> colour_minimum, colour_maximum;  // default: see above
    std::string title;                                     // rich text: $italic$, _{sub}, ^{super}
    bool ambient_occlusion = true;
    bool antialiasing = true;
    bool triad = true, colour_bar = true, outline = true;
    ViewDirection direction;
    double zoom = 1;
    std::optional<ClipPlane> clip;
    std::vector<Sphere> seen;  // what the camera shows; default: what is in the picture
};

class KeptWindow;

/// Several pictures of one size are drawn faster in a window that is kept.
Image render_particles(vtkPolyData* particles, const ParticleView& view,
                       KeptWindow* window = nullptr);

/// The chains of strong contacts: rods along the lines of `contacts` whose value is above the mean,
/// coloured and thick by it, between small grey spheres. `colour_by` is a cell array of the
/// contacts with one component.
Image render_chains(vtkPolyData* particles, vtkPolyData* contacts, const ParticleView& view,
                    KeptWindow* window = nullptr);

/// What an array says of colours.
struct ColourValues {
    std::vector<double> values;  // lengths of vectors
    bool whole_numbers = false;
};
ColourValues colour_values(vtkDataSetAttributes* arrays, const std::string& name);

}
