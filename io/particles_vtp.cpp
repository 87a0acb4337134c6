#include "io/particles_vtp.h"

#include "engine/error.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkInformation.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <array>

namespace sigmaflow::io {
namespace {

constexpr std::array vector_names{"X", "Y", "Z"};
constexpr std::array tensor_names{"XX", "XY", "XZ", "YX", "YY", "YZ", "ZX", "ZY", "ZZ"};

vtkNew<vtkDoubleArray> double_array(const char* name, const char* unit, vtkIdType tuples,
                                    int components)
{
    vtkNew<vtkDoubleArray> array;
    array->SetName(name);
    array->SetNumberOfComponents(components);
    array->SetNumberOfTuples(tuples);
    array->GetInformation()->Set(vtkDataArray::UNITS_LABEL(), unit);
    for (int k = 0; k < components && components > 1; ++k)
        array->SetComponentName(k, components == 3 ? vector_names.at(static_cast<std::size_t>(k))
                                                   : tensor_names.at(static_cast<std::size_t>(k)));
    return array;
}

/// value(k) for k in [0, count).
template <class Value>
void add_numbers(vtkFieldData* data, const char* name, const char* unit, std::size_t count,
                 const Value& value)
{
    const auto array = double_array(name, unit, static_cast<vtkIdType>(count), 1);
    for (std::size_t k = 0; k < count; ++k) array->SetValue(static_cast<vtkIdType>(k), value(k));
    data->AddArray(array);
}

void add_vectors(vtkFieldData* data, const char* name, const char* unit,
                 const std::vector<Vec3>& vectors)
{
    const auto array = double_array(name, unit, static_cast<vtkIdType>(vectors.size()), 3);
    for (std::size_t k = 0; k < vectors.size(); ++k)
        array->SetTuple(static_cast<vtkIdType>(k), vectors[k].data());
    data->AddArray(array);
}

void add_tensors(vtkFieldData* data, const char* name, const char* unit,
                 const std::vector<Mat3>& tensors)
{
    const auto array = double_array(name, unit, static_cast<vtkIdType>(tensors.size()), 9);
    for (std::size_t k = 0; k < tensors.size(); ++k) {
        const Mat3 row_by_row = tensors[k].transpose();  // Eigen stores columns
        array->SetTuple(static_cast<vtkIdType>(k), row_by_row.data());
    }
    data->AddArray(array);
}

template <class Value>
void add_integers(vtkFieldData* data, const char* name, std::size_t count, const Value& value)
{
    vtkNew<vtkIntArray> array;
    array->SetName(name);
    array->SetNumberOfTuples(static_cast<vtkIdType>(count));
    for (std::size_t k = 0; k < count; ++k)
        array->SetValue(static_cast<vtkIdType>(k), static_cast<int>(value(k)));
    data->AddArray(array);
}

/// What ParaView and the pictures tell about the instant.
void add_field_data(vtkPolyData* polydata, const Frame& frame)
{
    const auto add = [&](const char* name, const char* unit, const std::vector<double>& values) {
        add_numbers(polydata->GetFieldData(), name, unit, values.size(),
                    [&](std::size_t k) { return values[k]; });
    };
    const Box& box = frame.state.box;
    add("TimeValue", "-", {frame.state.strain});
    add("strain", "-", {frame.state.strain});
    add("time", "1/rate0", {frame.state.time});
    add("shear_rate", "rate0", {frame.sample.shear_rate});
    add("shear_stress", "sigma0", {frame.sample.shear_stress});
    add("volume_fraction", "-", {frame.volume_fraction});
    add("box_length", "a", {box.length.x(), box.length.y(), box.length.z()});
    add("box_offset", "a", {box.offset});
}

vtkNew<vtkPoints> double_points()
{
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    return points;
}

void require_complete(const Frame& frame)
{
    const std::size_t n = frame.state.radius.size();
    const std::array sizes{frame.state.position.size(),   frame.velocity.size(),
                           frame.angular_velocity.size(), frame.nonaffine_velocity.size(),
                           frame.nonaffine_speed.size(),  frame.contact_number.size(),
                           frame.species.size(),          frame.particle_stress.size()};
    for (const std::size_t size : sizes)
        if (size != n)
            throw Error(ErrorKind::internal, "particles_polydata",
                        "every array of a frame must have " + std::to_string(n) + " entries, got " +
                            std::to_string(size));
}

}

vtkSmartPointer<vtkPolyData> particles_polydata(const Frame& frame)
{
    require_complete(frame);
    const std::size_t n = frame.state.radius.size();
    const auto points = double_points();
    vtkNew<vtkCellArray> vertices;
    for (const Vec3& place : frame.state.position) {
        const vtkIdType index = points->InsertNextPoint(place.data());
        vertices->InsertNextCell(1, &index);  // without cells, sphere mappers draw nothing
    }
    auto polydata = vtkSmartPointer<vtkPolyData>::New();
    polydata->SetPoints(points);
    polydata->SetVerts(vertices);

    vtkPointData* data = polydata->GetPointData();
    add_numbers(data, "nonaffine_speed", "-", n,
                [&](std::size_t k) { return frame.nonaffine_speed[k]; });
    add_numbers(data, "radius", "a", n, [&](std::size_t k) { return frame.state.radius[k]; });
    add_vectors(data, "velocity", "a rate0", frame.velocity);
    add_vectors(data, "nonaffine_velocity", "a rate0", frame.nonaffine_velocity);
    add_vectors(data, "angular_velocity", "rate0", frame.angular_velocity);
    add_integers(data, "contact_number", n, [&](std::size_t k) { return frame.contact_number[k]; });
    add_integers(data, "species", n, [&](std::size_t k) { return frame.species[k]; });
    add_tensors(data, "stress", "sigma0 a^3", frame.particle_stress);
    add_integers(data, "id", n, [](std::size_t k) { return k; });
    data->SetActiveScalars("nonaffine_speed");
    data->SetActiveVectors("velocity");
    add_field_data(polydata, frame);
    return polydata;
}

vtkSmartPointer<vtkPolyData> contacts_polydata(const Frame& frame)
{
    const std::vector<ContactForce>& contacts = frame.contacts;
    const std::size_t n = contacts.size();
    const auto points = double_points();
    vtkNew<vtkCellArray> lines;
    for (const ContactForce& contact : contacts) {
        const std::array<vtkIdType, 2> ends{points->InsertNextPoint(contact.start.data()),
                                            points->InsertNextPoint(contact.end.data())};
        lines->InsertNextCell(2, ends.data());
    }
    auto polydata = vtkSmartPointer<vtkPolyData>::New();
    polydata->SetPoints(points);
    polydata->SetLines(lines);

    vtkCellData* data = polydata->GetCellData();
    add_numbers(data, "normal_force", "F*", n,
                [&](std::size_t k) { return contacts[k].normal_force; });
    add_numbers(data, "tangential_force", "F*", n,
                [&](std::size_t k) { return contacts[k].tangential_force.norm(); });
    add_numbers(data, "xi", "-", n, [&](std::size_t k) { return contacts[k].xi; });
    add_integers(data, "sliding", n, [&](std::size_t k) { return contacts[k].sliding; });
    add_integers(data, "frictional", n, [&](std::size_t k) { return contacts[k].frictional; });
    add_integers(data, "i", n, [&](std::size_t k) { return contacts[k].i; });
    add_integers(data, "j", n, [&](std::size_t k) { return contacts[k].j; });
    data->SetActiveScalars("normal_force");
    // Tube filters need a point array for the radius.
    add_numbers(polydata->GetPointData(), "normal_force_point", "F*", 2 * n,
                [&](std::size_t k) { return contacts[k / 2].normal_force; });
    polydata->GetPointData()->SetActiveScalars("normal_force_point");
    add_field_data(polydata, frame);
    return polydata;
}

vtkSmartPointer<vtkPolyData> box_polydata(const Box& box)
{
    const auto points = double_points();
    vtkNew<vtkCellArray> lines;
    for (vtkIdType corner = 0; corner < 8; ++corner) {  // bit k of a corner: at the end of axis k
        points->InsertNextPoint(corner & 1 ? box.length.x() : 0, corner & 2 ? box.length.y() : 0,
                                corner & 4 ? box.length.z() : 0);
        for (const vtkIdType axis : {1, 2, 4})
            if ((corner & axis) == 0) {
                const std::array<vtkIdType, 2> ends{corner, corner | axis};
                lines->InsertNextCell(2, ends.data());
            }
    }
    auto polydata = vtkSmartPointer<vtkPolyData>::New();
    polydata->SetPoints(points);
    polydata->SetLines(lines);
    return polydata;
}

}
