// tests/render/scenes.cpp
#include "tests/render/scenes.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <cmath>

namespace sigmaflow::test {

vtkSmartPointer<vtkPolyData> polydata(const std::vector<Ball>& balls)
{
    vtkNew<vtkPoints> points;
    vtkNew<vtkDoubleArray> radius, speed, velocity;
    vtkNew<vtkIntArray> contacts;
    radius->SetName("radius");
    speed->SetName("nonaffine_speed");
    velocity->SetName("velocity");
    velocity->SetNumberOfComponents(3);
    contacts->SetName("contact_number");
    for (const Ball& ball : balls) {
        points->InsertNextPoint(ball.centre.data());
        radius->InsertNextValue(ball.radius);
        speed->InsertNextValue(ball.value);
        velocity->InsertNextTuple3(ball.value, 0, 0);
        contacts->InsertNextValue(static_cast<int>(ball.value));
    }
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points);
    data->GetPointData()->AddArray(radius);
    data->GetPointData()->AddArray(speed);
    data->GetPointData()->AddArray(velocity);
    data->GetPointData()->AddArray(contacts);
    return data;
}

vtkSmartPointer<vtkPolyData> contacts(const std::vector<Rod>& rods)
{
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> lines;
    vtkNew<vtkDoubleArray> forces;
    forces->SetName("normal_force");
    for (const Rod& rod : rods) {
        const vtkIdType ends[2] = {points->InsertNextPoint(rod.from.data()),
                                   points->InsertNextPoint(rod.to.data())};
        lines->InsertNextCell(2, ends);
        forces->InsertNextValue(rod.force);
    }
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points);
    data->SetLines(lines);
    data->GetCellData()->AddArray(forces);
    return data;
}

std::vector<Ball> shaken_lattice(std::array<int, 3> cells)
{
    std::vector<Ball> balls;
    constexpr double spacing = 2.6;
    for (int x = 0; x < cells[0]; ++x) {
        for (int y = 0; y < cells[1]; ++y) {
            for (int z = 0; z < cells[2]; ++z) {
                const double k = static_cast<double>(balls.size());
                const auto shaken = [&](int cell, double pace) {
                    return spacing * (cell + 0.5) + 0.25 * std::sin(pace * k);
                };
                balls.push_back({{shaken(x, 1.7), shaken(y, 2.9), shaken(z, 4.3)},
                                 balls.size() % 2 ? 1.4 : 1.0,
                                 0.5 + 0.5 * std::sin(0.9 * k)});
            }
        }
    }
    return balls;
}

render::ParticleView bare_view(int width, int height)
{
    render::ParticleView view;
    view.width = width;
    view.height = height;
    view.triad = view.colour_bar = view.outline = false;
    view.ambient_occlusion = view.antialiasing = false;
    view.colour_minimum = 0;
    view.colour_maximum = 1;
    return view;
}

render::Plot linear_plot()
{
    render::Plot plot;
    plot.width = plot.height = 300;
    plot.title = "$φ$ = 0.56";
    plot.x.title = "strain $γ$";
    plot.y.title = "rate $γ̇$/$γ̇$_{0}";
    render::Series curve, mean;
    for (int i = 0; i <= 200; ++i) {
        const double strain = 0.05 * i;
        curve.x.push_back(strain);
        curve.y.push_back(0.02 + 0.02 * std::exp(-2 * strain) + 0.001 * std::sin(7 * strain));
    }
    curve.label = "rate";
    mean.label = "mean";
    mean.x = {2, 6, 10};
    mean.y = {0.02, 0.02, 0.02};
    mean.y_error = {0.002, 0.001, 0.002};
    mean.marker = render::Marker::circle;
    plot.series = {curve, mean};
    plot.bands.push_back({"", {2, 10}, {0.019, 0.019}, {0.021, 0.021}, render::Colour{213, 94, 0}});
    plot.spans.push_back({0, 2, "start"});
    return plot;
}

render::Plot log_plot()
{
    render::Plot plot;
    plot.width = plot.height = 300;
    plot.x.title = "$σ$/$σ$_{0}";
    plot.y.title = "$η$_{r}";
    plot.x.logarithmic = plot.y.logarithmic = true;
    const std::array markers{render::Marker::square, render::Marker::triangle,
                             render::Marker::diamond};
    for (int s = 0; s < 3; ++s) {
        render::Series series;
        series.label = "series " + std::to_string(s + 1);
        series.marker = markers[s];
        series.open_marker = s == 1;
        series.line = s == 2 ? render::Line::dashed : render::Line::solid;
        for (int i = 0; i <= 6; ++i) {
            series.x.push_back(0.1 * std::pow(10, i / 2.0));
            series.y.push_back(10 * (s + 1) * std::pow(10, 0.3 * i));
        }
        plot.series.push_back(series);
    }
    return plot;
}

}
