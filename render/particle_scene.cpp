// render/particle_scene.cpp
//
// Spheres are imposters (vtkOpenGLSphereMapper): squares on which the shader finds the exact
// sphere, so outlines and depths are exact at any size. Edges are smoothed twice: FXAA on a picture
// of double size, which is then shrunk.
#include "render/particle_scene.h"

#include "render/offscreen.h"

#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkLight.h>
#include <vtkNew.h>
#include <vtkOpenGLFXAAPass.h>
#include <vtkOpenGLRenderer.h>
#include <vtkOpenGLSphereMapper.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderStepsPass.h>
#include <vtkRenderWindow.h>
#include <vtkSSAOPass.h>
#include <vtkTubeFilter.h>
#include <vtkUnsignedCharArray.h>
#include <algorithm>
#include <cmath>

namespace sigmaflow::render {
namespace {

constexpr int oversampling = 2;

vtkSmartPointer<vtkPolyData> sphere_data(const std::vector<ColouredSphere>& spheres)
{
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> vertices;
    vtkNew<vtkFloatArray> radii;
    vtkNew<vtkUnsignedCharArray> colours;
    radii->SetName("radius");
    colours->SetName("colour");
    colours->SetNumberOfComponents(3);
    for (const ColouredSphere& s : spheres) {
        const vtkIdType id = points->InsertNextPoint(s.sphere.centre.data());
        vertices->InsertNextCell(1, &id);  // without cells the imposters are not drawn
        radii->InsertNextValue(static_cast<float>(s.sphere.radius));
        for (int channel : s.colour) colours->InsertNextValue(static_cast<unsigned char>(channel));
    }
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points);
    data->SetVerts(vertices);
    data->GetPointData()->AddArray(radii);
    data->GetPointData()->AddArray(colours);
    return data;
}

void set_material(vtkProperty* property)
{
    property->SetAmbient(0.34);
    property->SetDiffuse(0.80);
    property->SetSpecular(0.16);
    property->SetSpecularPower(30);
}

/// Lit, in the colours of the point array "colour".
vtkSmartPointer<vtkActor> coloured_actor(vtkMapper* mapper)
{
    mapper->SetScalarModeToUsePointFieldData();
    mapper->SelectColorArray("colour");
    mapper->SetColorModeToDirectScalars();
    auto actor = vtkSmartPointer<vtkActor>::New();
    actor->SetMapper(mapper);
    set_material(actor->GetProperty());
    return actor;
}

vtkSmartPointer<vtkActor> sphere_actor(const std::vector<ColouredSphere>& spheres)
{
    vtkNew<vtkOpenGLSphereMapper> mapper;
    mapper->SetInputData(sphere_data(spheres));
    mapper->SetScaleArray("radius");
    return coloured_actor(mapper);
}

vtkSmartPointer<vtkActor> rod_actor(const std::vector<ColouredRod>& rods)
{
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> lines;
    vtkNew<vtkDoubleArray> radii;
    vtkNew<vtkUnsignedCharArray> colours;
    radii->SetName("radius");
    colours->SetName("colour");
    colours->SetNumberOfComponents(3);
    for (const ColouredRod& rod : rods) {
        const vtkIdType ends[2] = {points->InsertNextPoint(rod.from.data()),
                                   points->InsertNextPoint(rod.to.data())};
        lines->InsertNextCell(2, ends);
        for (int end = 0; end < 2; ++end) {
            radii->InsertNextValue(rod.radius);
            for (int channel : rod.colour)
                colours->InsertNextValue(static_cast<unsigned char>(channel));
        }
    }
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetLines(lines);
    data->GetPointData()->SetScalars(radii);
    data->GetPointData()->AddArray(colours);
    vtkNew<vtkTubeFilter> tubes;
    tubes->SetInputData(data);
    tubes->SetVaryRadiusToVaryRadiusByAbsoluteScalar();
    tubes->SetNumberOfSides(16);
    tubes->CappingOn();
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputConnection(tubes->GetOutputPort());
    return coloured_actor(mapper);
}

/// Thin tubes rather than lines: they are hidden by spheres exactly and smoothed like everything
/// else.
vtkSmartPointer<vtkActor> outline_actor(const std::array<double, 3>& length, double radius)
{
    vtkNew<vtkPoints> corners;
    vtkNew<vtkCellArray> edges;
    for (int corner = 0; corner < 8; ++corner) {
        corners->InsertNextPoint(corner & 1 ? length[0] : 0, corner & 2 ? length[1] : 0,
                                 corner & 4 ? length[2] : 0);
        for (int axis : {1, 2, 4}) {
            if (corner & axis) continue;
            const vtkIdType ends[2] = {corner, corner | axis};
            edges->InsertNextCell(2, ends);
        }
    }
    vtkNew<vtkPolyData> data;
    data->SetPoints(corners);
    data->SetLines(edges);
    vtkNew<vtkTubeFilter> tubes;
    tubes->SetInputData(data);
    tubes->SetRadius(radius);
    tubes->SetNumberOfSides(12);
    tubes->CappingOn();
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputConnection(tubes->GetOutputPort());
    auto actor = vtkSmartPointer<vtkActor>::New();
    actor->SetMapper(mapper);
    actor->GetProperty()->SetColor(0.13, 0.13, 0.16);
    actor->GetProperty()->LightingOff();
    return actor;
}

/// Fixed to the camera: a key light from the upper left, a weak fill light from the right.
void add_lights(vtkRenderer* renderer)
{
    const auto add = [&](double x, double y, double z, double intensity) {
        vtkNew<vtkLight> light;
        light->SetLightTypeToCameraLight();
        light->SetPosition(x, y, z);
        light->SetFocalPoint(0, 0, 0);
        light->SetIntensity(intensity);
        renderer->AddLight(light);
    };
    add(-0.45, 0.75, 1.0, 0.85);
    add(0.8, -0.2, 0.7, 0.22);
    add(0.0, 0.0, 1.0, 0.18);
}

void place_camera(vtkRenderer* renderer, const Camera& camera)
{
    vtkCamera* vtk = renderer->GetActiveCamera();
    vtk->SetFocalPoint(camera.focus.data());
    vtk->SetPosition(camera.position().data());
    vtk->SetViewUp(camera.axes.up.data());
    vtk->SetViewAngle(camera.view_angle());
}

/// The nearest and farthest things seen; VTK's own guess knows nothing about the size of spheres.
void set_clipping(vtkRenderer* renderer, const ParticleScene& scene)
{
    double nearest = 1e300, farthest = 0;
    const auto include = [&](const Position& p, double radius) {
        nearest = std::min(nearest, scene.camera.depth(p) - radius);
        farthest = std::max(farthest, scene.camera.depth(p) + radius);
    };
    for (const ColouredSphere& s : scene.spheres) include(s.sphere.centre, s.sphere.radius);
    for (const ColouredRod& rod : scene.rods)
        for (const Position& end : {rod.from, rod.to}) include(end, rod.radius);
    for (int corner = 0; corner < 8; ++corner)
        include({corner & 1 ? scene.box_length[0] : 0, corner & 2 ? scene.box_length[1] : 0,
                 corner & 4 ? scene.box_length[2] : 0},
                0);
    renderer->GetActiveCamera()->SetClippingRange(0.98 * nearest, 1.02 * farthest);
}

double mean_radius(const ParticleScene& scene)
{
    double sum = 0;
    for (const ColouredSphere& s : scene.spheres) sum += s.sphere.radius;
    return scene.spheres.empty() ? 0 : sum / scene.spheres.size();
}

/// The chain of passes: draw, darken the gaps between spheres, smooth the edges.
struct Passes {
    vtkNew<vtkRenderStepsPass> steps;
    vtkNew<vtkSSAOPass> occlusion;
    vtkNew<vtkOpenGLFXAAPass> smoothing;

    Passes(vtkRenderer* renderer, const ParticleScene& scene)
    {
        vtkRenderPass* last = steps;
        const double radius = mean_radius(scene);
        if (scene.ambient_occlusion && radius > 0) {
            occlusion->SetRadius(1.9 * radius);
            occlusion->SetBias(0.05 * radius);
            occlusion->SetKernelSize(96);
            occlusion->BlurOn();
            occlusion->SetDelegatePass(last);
            last = occlusion;
        }
        if (scene.antialiasing) {
            smoothing->SetDelegatePass(last);
            last = smoothing;
        }
        renderer->SetPass(last);
    }

    void release(vtkWindow* window)
    {
        smoothing->ReleaseGraphicsResources(window);
        occlusion->ReleaseGraphicsResources(window);
        steps->ReleaseGraphicsResources(window);
    }
};

}

Image render_scene(const ParticleScene& scene, KeptWindow* kept)
{
    const VtkMessages messages;
    const int factor = scene.antialiasing ? oversampling : 1;
    KeptWindow own;
    const auto window =
        (kept ? *kept : own).of_size(factor * scene.camera.width, factor * scene.camera.height);
    vtkNew<vtkOpenGLRenderer> renderer;
    renderer->SetBackground(1, 1, 1);
    renderer->AutomaticLightCreationOff();
    if (!scene.spheres.empty()) renderer->AddActor(sphere_actor(scene.spheres));
    if (!scene.rods.empty()) renderer->AddActor(rod_actor(scene.rods));
    const auto& length = scene.box_length;
    if (length[0] > 0 && length[1] > 0 && length[2] > 0) {
        // Some 2.4 pixels wide in a picture 1000 pixels high, in the middle of the box.
        const double pixels = std::max(1.4, 2.4 * scene.camera.height / 1000);
        const double size = 2 * scene.camera.half_height * scene.camera.distance;
        renderer->AddActor(outline_actor(length, 0.5 * pixels * size / scene.camera.height));
    }
    add_lights(renderer);
    place_camera(renderer, scene.camera);
    set_clipping(renderer, scene);
    window->AddRenderer(renderer);
    Passes passes(renderer, scene);
    window->Render();
    Image image = read_pixels(window);
    passes.release(window);
    window->RemoveRenderer(renderer);
    messages.throw_if_error();
    return factor == 1 ? image : shrink(image, factor);
}

}
