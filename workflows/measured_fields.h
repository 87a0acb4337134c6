// workflows/measured_fields.h -- fields across the box at the instants of a run, for the step
// "uniformity".
#pragma once
#include "engine/frame.h"
#include "engine/uniformity.h"
#include "workflows/step.h"

#include <string>
#include <vector>

namespace sigmaflow::workflows {

/// One field in slabs across y or z, over its scale.
struct MeasuredField {
    std::string name;    // as in the time series
    std::string symbol;  // rich text of the field over its scale
    Axis axis = gradient;
    double scale = 1;              // what it is divided by
    std::vector<double> position;  // of the slabs over the length of the box
    Field values;                  // [instants][slabs]

    std::string axis_name() const { return axis == gradient ? "y" : "z"; }
};

/// All fields of frames: velocity (u - y, or u across z), local shear rate (across y), volume
/// fraction, shear stress, frictional contact number. A field whose mean is not positive is left
/// out.
std::vector<MeasuredField> measured_fields(const std::vector<const Frame*>& frames, int slabs,
                                           double mean_rate);

/// The one with this name across this axis; null: left out.
const MeasuredField* find_field(const std::vector<MeasuredField>& fields, const std::string& name,
                                Axis axis);

/// Mean of a field over its instants with the standard error of each slab, from their scatter.
struct FieldMean {
    std::vector<double> mean, standard_error;  // no error from one instant
};
FieldMean mean_of(const MeasuredField& field);

/// Position and all fields across one axis with their errors.
std::string fields_csv(const std::vector<MeasuredField>& fields, Axis axis);

}
