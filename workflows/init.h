// workflows/init.h -- a workflow to start from.
#pragma once
#include <filesystem>

namespace sigmaflow::workflows {

/// Writes a commented workflow to `file` and workflow.schema.json beside it (for editors). Nothing
/// is overwritten: errors are usage (the file exists, or its name does not end with .json), file,
/// no_space.
void write_first_workflow(const std::filesystem::path& file);

}
