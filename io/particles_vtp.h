// io/particles_vtp.h -- frames as VTK data: for ParaView files and for our own pictures.
//
// particles_polydata: one vertex per particle at its stored position; point arrays
//   nonaffine_speed (active scalars), radius, velocity (active vectors), nonaffine_velocity,
//   angular_velocity, contact_number, species, stress (XX, XY, ... ZZ; sigma0 a^3), id
//   field data: TimeValue (= strain), strain, time, shear_rate, shear_stress, volume_fraction,
//   box_length (3), box_offset
// contacts_polydata: one line per contact from centre to centre; cell arrays normal_force (active
//   scalars), tangential_force (magnitude), xi, sliding, frictional, i, j; point array
//   normal_force_point (active scalars); the same field data
// box_polydata: the twelve edges of the box, at right angles: the box in which positions are
// wrapped. Floating-point arrays are double and carry their unit as vtkDataArray::UNITS_LABEL.
//
// Order of the lists of the frame. Error(internal) if an array of the frame is shorter or
// longer than the list of particles.
//
// write_vtp: VTK's own writer, inline binary zlib (the only form that every Debian 12 ParaView
// reads), complete under its name or not there. Errors: file, no_space. read_vtp: missing, input.
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

struct VtpSummary {
    std::size_t points = 0, cells = 0, arrays = 0;
};

/// read_vtp, and every point must be finite and every array as long as the list that it belongs to.
VtpSummary check_vtp(const std::filesystem::path& path);

/// One entry of a ParaView collection; file is relative to the collection.
struct SeriesEntry {
    double time;
    std::string file;
};
void write_pvd(const std::filesystem::path& path, const std::vector<SeriesEntry>& entries);

}
