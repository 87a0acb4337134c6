// tests/render/scenes.h -- particles and plots that several tests draw.
#pragma once
#include "render/line_plot.h"
#include "render/particles.h"

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <array>
#include <vector>

namespace sigmaflow::test {

struct Ball {
    std::array<double, 3> centre;
    double radius;
    double value;
};

/// Point arrays `radius` and `nonaffine_speed` (= value), `velocity` = (value, 0, 0) and
/// `contact_number` = value rounded down. Without vertex cells, which a picture must not need.
vtkSmartPointer<vtkPolyData> polydata(const std::vector<Ball>& balls);

struct Rod {
    std::array<double, 3> from, to;
    double force;
};

/// Lines with the cell array `normal_force`.
vtkSmartPointer<vtkPolyData> contacts(const std::vector<Rod>& rods);

/// A cubic lattice, shaken by a fixed rule, radii 1 and 1.4, values from 0 to about 1; it fills a
/// box with the edge lengths 2.6 * cells.
std::vector<Ball> shaken_lattice(std::array<int, 3> cells);

/// Nothing around the particles, no smoothing, no shadows: fast, and every pixel off the spheres
/// is white.
render::ParticleView bare_view(int width, int height);

render::Plot linear_plot();
render::Plot log_plot();

}
