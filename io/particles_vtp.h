// io/particles_vtp.h -- frames as VTK data: for ParaView files and for our own pictures.
//
// particles_polydata: one vertex per particle, point arrays
//   nonaffine_speed (active scalars), radius, velocity, nonaffine_velocity, angular_velocity,
//   contact_number, species, stress (9 components, sigma0 a^3), id
//   field data: TimeValue (= strain), strain, time, shear_rate, shear_stress, volume_fraction,
//   box_length (3), box_offset
// contacts_polydata: one line per contact, cell arrays normal_force, tangential_force (magnitude),
//   xi, sliding, frictional, i, j; point array normal_force_point
// write_vtp: VTK's own writer, inline binary zlib (the only form that every Debian 12 ParaView
// reads),
//   to a temporary file, then renamed. Errors: file, no_space.
#pragma once
#include "engine/frame.h"

#include <vtkSmartPointer.h>
#include <filesystem>
#include <string>
#include <vector>

class vtkPolyData;

namespace sigmaflow::io {

vtkSmartPointer<vtkPolyData> particles_polydata(const Frame& frame);
vtkSmartPointer<vtkPolyData> contacts_polydata(const Frame& frame);
vtkSmartPointer<vtkPolyData> box_polydata(const Box& box);

void write_vtp(const std::filesystem::path& path, vtkPolyData* data);
vtkSmartPointer<vtkPolyData> read_vtp(const std::filesystem::path& path);

/// One entry of a ParaView collection; file is relative to the collection.
struct SeriesEntry {
    double time;
    std::string file;
};
void write_pvd(const std::filesystem::path& path, const std::vector<SeriesEntry>& entries);

}
