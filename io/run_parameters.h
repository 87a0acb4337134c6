// io/run_parameters.h -- the model and what was imposed, as attributes of the group /parameters.
//
// Names, units and limits are those of the workflow files (io/model_fields.h), and `stress`
// [sigma0] or `rate` [rate0] for the control. The units are attributes of the same names of
// /parameters/unit.
#pragma once
#include "engine/model.h"
#include "io/hdf5_group.h"

namespace sigmaflow::io {

struct RunParameters {
    Model model;
    Control control;
};

void write_parameters(const Hdf5Group& file, const RunParameters& parameters);

/// Errors: input (an attribute is missing, unknown or out of range).
RunParameters read_parameters(const Hdf5Group& file);

}
