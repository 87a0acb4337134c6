#include "workflows/init.h"

#include "engine/error.h"
#include "io/atomic_file.h"
#include "workflows/schema.h"

namespace sigmaflow::workflows {

namespace {

constexpr const char* first_workflow = R"({
  "$schema": "workflow.schema.json",
  "description": "Frictional spheres sheared at an imposed stress. Units: small radius, solvent viscosity and F*/(6 pi) are 1.",
  "suspension": {
    "comment": "sigmaflow explain suspension, sigmaflow explain model",
    "particles": 200,
    "volume_fraction": 0.54,
    "size_ratio": 1.4,
    "seed": 1,
    "model": {
      "friction_static": 1,
      "friction_dynamic": 1,
      "debye_length": 0.02
    }
  },
  "steps": [
    {
      "comment": "a random packing without overlaps, at exactly this volume fraction",
      "step": "pack"
    },
    {
      "comment": "shears until the shear rate no longer drifts; its series can be left out of averages",
      "step": "equilibrate",
      "stress": 2,
      "minimum_strain": 1,
      "maximum_strain": 4
    },
    {
      "comment": "the run itself: run.h5, series.csv and ParaView files in the folder shear/",
      "step": "shear",
      "stress": 2,
      "strain": 5,
      "series_interval": 0.01,
      "frame_interval": 0.25
    },
    {
      "comment": "is the flow uniform? mean velocity across the gradient direction, with errors",
      "step": "velocity_profile"
    },
    {
      "comment": "the spheres of the last frame, coloured by their non-affine speed",
      "step": "snapshot"
    },
    {
      "comment": "any column of the series against strain",
      "step": "plot",
      "y": "viscosity"
    }
  ]
}
)";

}

void write_first_workflow(const std::filesystem::path& file)
{
    const auto refuse = [&](const char* problem) {
        throw Error(ErrorKind::usage, file.string(), problem);
    };
    if (file.extension() != ".json") refuse("must be a name that ends with .json");
    std::error_code unknown;
    if (std::filesystem::exists(std::filesystem::symlink_status(file, unknown)))
        refuse("exists, and init overwrites nothing");
    const std::filesystem::path schema = file.parent_path() / schema_name;
    if (!std::filesystem::exists(std::filesystem::symlink_status(schema, unknown)))
        io::write_file(schema, workflow_schema_text());
    io::write_file(file, first_workflow);
}

}
