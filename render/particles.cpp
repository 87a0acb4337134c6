// render/particles.cpp -- a picture of particles: values to colours, camera, scene, and what is
// around.
#include "render/particles.h"

#include "engine/error.h"
#include "render/particle_overlay.h"
#include "render/particle_scene.h"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkIdList.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace sigmaflow::render {
namespace {

vtkDataArray* array_of(vtkDataSetAttributes* arrays, const std::string& name, const char* where)
{
    if (vtkDataArray* array = arrays->GetArray(name.c_str())) return array;
    std::string names;
    for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
        if (const char* known = arrays->GetArrayName(i))
            names += (names.empty() ? "" : ", ") + std::string(known);
    throw Error(
        ErrorKind::input, where,
        "there is no array \"" + name + "\", there are: " + (names.empty() ? "none" : names));
}

/// The values themselves, or the lengths of vectors (Frobenius norms of tensors).
std::vector<double> magnitudes(vtkDataArray* array)
{
    const int components = array->GetNumberOfComponents();
    std::vector<double> values(array->GetNumberOfTuples());
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (components == 1) {
            values[i] = array->GetComponent(i, 0);
            continue;
        }
        double sum = 0;
        for (int c = 0; c < components; ++c) sum += std::pow(array->GetComponent(i, c), 2);
        values[i] = std::sqrt(sum);
    }
    return values;
}

bool holds_whole_numbers(vtkDataArray* array)
{
    const int type = array->GetDataType();
    return array->GetNumberOfComponents() == 1 && type != VTK_FLOAT && type != VTK_DOUBLE;
}

ColourScale colour_scale(const ParticleView& view, const std::vector<double>& values,
                         bool whole_numbers)
{
    ColourScale scale;
    scale.map = view.colour_map;
    scale.whole_numbers = whole_numbers;
    scale.label = view.colour_label.empty() ? array_label(view.colour_by) : view.colour_label;
    scale.range = colour_range(values, whole_numbers);
    if (view.colour_minimum) scale.range.from = *view.colour_minimum;
    if (view.colour_maximum) scale.range.to = *view.colour_maximum;
    if (!std::isfinite(scale.range.to - scale.range.from) || scale.range.from >= scale.range.to)
        throw Error(ErrorKind::input, "colour range",
                    "colour_minimum must be below colour_maximum, got " +
                        std::to_string(scale.range.from) + " and " +
                        std::to_string(scale.range.to));
    const double slack = 1e-9 * (scale.range.to - scale.range.from);
    for (double value : values) {
        scale.values_below = scale.values_below || value < scale.range.from - slack;
        scale.values_above = scale.values_above || value > scale.range.to + slack;
    }
    return scale;
}

std::vector<ColouredSphere> coloured_spheres(vtkPolyData* particles,
                                             const std::vector<double>& values,
                                             const ColourScale& scale)
{
    std::vector<ColouredSphere> spheres(values.size());
    if (spheres.empty()) return spheres;
    vtkDataArray* radii = array_of(particles->GetPointData(), "radius", "radius");
    for (std::size_t i = 0; i < spheres.size(); ++i) {
        Sphere& sphere = spheres[i].sphere;
        particles->GetPoint(i, sphere.centre.data());
        sphere.radius = radii->GetComponent(i, 0);
        const double sum = sphere.centre[0] + sphere.centre[1] + sphere.centre[2];
        if (!std::isfinite(sum) || !(sphere.radius > 0) || !std::isfinite(sphere.radius))
            throw Error(ErrorKind::input, "particle " + std::to_string(i),
                        "position and radius must be finite and the radius > 0, got radius " +
                            std::to_string(sphere.radius));
        spheres[i].colour = scale.colour(values[i]);
    }
    return spheres;
}

void check(const ParticleView& view)
{
    for (int size : {view.width, view.height})
        if (size < 64 || size > 16384)
            throw Error(ErrorKind::input, "picture",
                        "the size must be in [64, 16384] pixels, got " + std::to_string(size));
    if (!(view.zoom >= 0.1 && view.zoom <= 100))
        throw Error(ErrorKind::input, "picture",
                    "zoom must be in [0.1, 100], got " + std::to_string(view.zoom));
}

double coordinate(const Position& p, int axis)
{
    return p[static_cast<std::size_t>(axis)];
}

/// Takes away what the plane hides.
void clip(ParticleScene& scene, const ClipPlane& plane)
{
    double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
    for (const ColouredSphere& s : scene.spheres) {
        lowest = std::min(lowest, coordinate(s.sphere.centre, plane.axis));
        highest = std::max(highest, coordinate(s.sphere.centre, plane.axis));
    }
    const std::size_t all = scene.spheres.size();
    std::erase_if(scene.spheres,
                  [&](const ColouredSphere& s) { return plane.hides(s.sphere.centre); });
    std::erase_if(scene.rods, [&](const ColouredRod& rod) {
        return plane.hides(rod.from) || plane.hides(rod.to);
    });
    if (scene.spheres.empty() && all > 0)
        throw Error(ErrorKind::input, "clip",
                    std::string("hides all particles, their centres have ") + "xyz"[plane.axis] +
                        " from " + std::to_string(lowest) + " to " + std::to_string(highest));
}

/// Everything that has to be in the picture.
std::vector<Sphere> contents(const ParticleScene& scene)
{
    std::vector<Sphere> spheres;
    for (const ColouredSphere& s : scene.spheres) spheres.push_back(s.sphere);
    for (const ColouredRod& rod : scene.rods)
        for (const Position& end : {rod.from, rod.to}) spheres.push_back({end, rod.radius});
    const auto& length = scene.box_length;
    for (int corner = 0; corner < 8; ++corner)
        if (length[0] > 0 && length[1] > 0 && length[2] > 0)
            spheres.push_back({{corner & 1 ? length[0] : 0, corner & 2 ? length[1] : 0,
                                corner & 4 ? length[2] : 0},
                               0});
    if (spheres.empty())
        throw Error(ErrorKind::input, "picture", "there are no particles and no box to draw");
    return spheres;
}

/// The scene with its camera, and everything around it.
Image picture_of(ParticleScene scene, const ColourScale& scale, const ParticleView& view,
                 KeptWindow* window)
{
    const ParticleLayout layout =
        particle_layout(view.width, view.height, !view.title.empty(), view.colour_bar, view.triad);
    if (view.outline) scene.box_length = view.box_length;
    scene.ambient_occlusion = view.ambient_occlusion;
    scene.antialiasing = view.antialiasing;
    const Rectangle& room = layout.particles;
    // before anything is hidden: the camera stands where it stands without the plane
    scene.camera = frame_spheres(view.seen.empty() ? contents(scene) : view.seen,
                                 static_cast<int>(room.width()), static_cast<int>(room.height()),
                                 view.direction, view.zoom);
    if (view.clip) clip(scene, *view.clip);
    for (const ColouredRod& rod : scene.rods)  // round ends
        for (const Position& end : {rod.from, rod.to})
            scene.spheres.push_back({{end, rod.radius}, rod.colour});

    const Fonts fonts;
    Drawing drawing{view.width, view.height, {}};
    if (view.colour_bar) draw_colour_bar(drawing, fonts, scale, layout);
    if (view.triad) draw_triad(drawing, fonts, layout, scene.camera.axes);
    if (!view.title.empty()) draw_title(drawing, fonts, view.title, layout);

    Image image(view.width, view.height);
    const Image spheres = render_scene(scene, window);
    paste(image, spheres, std::lround((room.left + room.right - spheres.width) / 2),
          std::lround((room.top + room.bottom - spheres.height) / 2));
    rasterise(drawing, image);
    return image;
}

/// As thick as half a small sphere at the end of the colours.
std::vector<ColouredRod> strong_rods(vtkPolyData* contacts, const std::vector<double>& values,
                                     const ColourScale& scale, double smallest_radius)
{
    std::vector<ColouredRod> rods;
    if (values.empty()) return rods;
    const double mean =
        std::accumulate(values.begin(), values.end(), 0.) / static_cast<double>(values.size());
    vtkNew<vtkIdList> ends;
    for (std::size_t k = 0; k < values.size(); ++k) {
        if (!(values[k] > mean)) continue;
        contacts->GetCellPoints(static_cast<vtkIdType>(k), ends);
        if (ends->GetNumberOfIds() != 2)
            throw Error(ErrorKind::input, "contact " + std::to_string(k), "must be a line");
        ColouredRod rod;
        contacts->GetPoint(ends->GetId(0), rod.from.data());
        contacts->GetPoint(ends->GetId(1), rod.to.data());
        rod.radius = smallest_radius / 2 * std::min(1., values[k] / scale.range.to);
        rod.colour = scale.colour(values[k]);
        rods.push_back(rod);
    }
    return rods;
}

}

ColourValues colour_values(vtkDataSetAttributes* arrays, const std::string& name)
{
    vtkDataArray* array = array_of(arrays, name, "colour_by");
    return {magnitudes(array), holds_whole_numbers(array)};
}

Image render_particles(vtkPolyData* particles, const ParticleView& view, KeptWindow* window)
{
    check(view);
    ColourValues found;
    if (particles->GetNumberOfPoints() > 0)
        found = colour_values(particles->GetPointData(), view.colour_by);
    const ColourScale scale = colour_scale(view, found.values, found.whole_numbers);
    ParticleScene scene;
    scene.spheres = coloured_spheres(particles, found.values, scale);
    return picture_of(std::move(scene), scale, view, window);
}

Image render_chains(vtkPolyData* particles, vtkPolyData* contacts, const ParticleView& view,
                    KeptWindow* window)
{
    check(view);
    constexpr Colour grey{176, 176, 182};
    constexpr double shown = 0.22;  // of the radii
    std::vector<double> values;
    if (contacts->GetNumberOfCells() > 0)
        values = magnitudes(array_of(contacts->GetCellData(), view.colour_by, "colour_by"));
    const ColourScale scale = colour_scale(view, values, false);
    ParticleScene scene;
    scene.spheres =
        coloured_spheres(particles, std::vector<double>(particles->GetNumberOfPoints()), scale);
    double smallest = std::numeric_limits<double>::infinity();
    for (ColouredSphere& s : scene.spheres) {
        smallest = std::min(smallest, s.sphere.radius);
        s.sphere.radius *= shown;
        s.colour = grey;
    }
    scene.rods = strong_rods(contacts, values, scale, smallest);
    return picture_of(std::move(scene), scale, view, window);
}

}
