// render/particle_scene.h -- lit spheres and rods and the box, drawn by VTK.
#pragma once
#include "render/framing.h"
#include "render/image.h"

#include <vector>

namespace sigmaflow::render {

struct ColouredSphere {
    Sphere sphere;
    Colour colour;
};

/// A round rod between two points.
struct ColouredRod {
    Position from{}, to{};
    double radius = 0;
    Colour colour;
};

struct ParticleScene {
    std::vector<ColouredSphere> spheres;
    std::vector<ColouredRod> rods;
    std::array<double, 3> box_length{};  // outline [0, L]; any length 0: no outline
    Camera camera;
    bool ambient_occlusion = true;
    bool antialiasing = true;
};

class KeptWindow;

/// camera.width x camera.height pixels on white, drawn in the kept window if there is one.
/// Error: rendering.
Image render_scene(const ParticleScene& scene, KeptWindow* kept = nullptr);

}
