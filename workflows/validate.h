// workflows/validate.h -- says what a file is, or why it is not what it should be. Computes
// nothing.
//
// Recognised: workflows (JSON with "steps"), cases (JSON with "kind"), runs (HDF5), VTK polydata,
// checkpoints and step records.
// All but JSON files are read by a child process with limits (io/guarded.h), so that whatever they
// hold, this process survives and needs little memory.
#pragma once
#include "io/json_override.h"

#include <filesystem>
#include <string>
#include <vector>

namespace sigmaflow::workflows {

/// One line: "flow.json: workflow, 6 steps, needs about 60 MB of memory and 9 MB on disk". Errors:
/// missing, input; usage (overrides of what is no JSON file).
std::string validate_file(const std::filesystem::path& path,
                          const std::vector<io::Override>& overrides = {});

}
