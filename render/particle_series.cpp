#include "render/particle_series.h"

#include "render/particle_overlay.h"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <algorithm>

namespace sigmaflow::render {

void ParticleSeries::include(const Position& centre, double radius)
{
    for (int axis = 0; axis < 3; ++axis) {
        low_[axis] = empty_ ? centre[axis] - radius : std::min(low_[axis], centre[axis] - radius);
        high_[axis] = empty_ ? centre[axis] + radius : std::max(high_[axis], centre[axis] + radius);
    }
    empty_ = false;
}

void ParticleSeries::add(vtkPolyData* particles, vtkPolyData* contacts)
{
    vtkDataArray* radii = particles->GetPointData()->GetArray("radius");
    for (vtkIdType i = 0; i < particles->GetNumberOfPoints(); ++i) {
        Position centre;
        particles->GetPoint(i, centre.data());
        include(centre, radii ? radii->GetComponent(i, 0) : 0);
    }
    for (vtkIdType i = 0; contacts && i < contacts->GetNumberOfPoints(); ++i) {
        Position end;
        contacts->GetPoint(i, end.data());
        include(end, 0);
    }
    vtkDataSetAttributes* arrays = particles->GetPointData();
    if (contacts) arrays = contacts->GetCellData();
    if (contacts ? contacts->GetNumberOfCells() == 0 : particles->GetNumberOfPoints() == 0) return;
    const ColourValues found = colour_values(arrays, view_.colour_by);
    values_.insert(values_.end(), found.values.begin(), found.values.end());
    whole_numbers_ = found.whole_numbers;
}

ParticleView ParticleSeries::view() const
{
    ParticleView view = view_;
    const Range range = colour_range(values_, whole_numbers_);
    view.colour_minimum = view.colour_minimum.value_or(range.from);
    view.colour_maximum = view.colour_maximum.value_or(range.to);
    for (int corner = 0; corner < 8 && !empty_; ++corner) {
        Sphere point;
        for (int axis = 0; axis < 3; ++axis) {
            const bool far_side = corner >> axis & 1;
            point.centre[axis] =
                far_side ? std::max(high_[axis], view.box_length[axis]) : std::min(low_[axis], 0.);
        }
        view.seen.push_back(point);
    }
    return view;
}

}
