// workflows/manifest.h -- manifest.json: what was run, by what, where, and which files it made.
#pragma once
#include "workflows/run_folder.h"
#include "workflows/workflow.h"

#include <nlohmann/json.hpp>
#include <string>

namespace sigmaflow::workflows {

/// Version of this program.
std::string version();

/// {"eigen": "3.4.0", "vtk": "9.1.0", ...}
nlohmann::ordered_json library_versions();

/// Now in ISO 8601, UTC, e.g. 2015-05-26T09:30:00Z.
std::string utc_now();

class Manifest {
public:
    Manifest(const Workflow& workflow, const std::filesystem::path& workflow_file, int threads);

    void add_step(const Step& step, double wall_seconds);
    /// Status: running, complete, pictures missing, failed. Errors: file, no_space.
    void write(RunFolder& folder, const std::string& status, const std::string& error = "");

private:
    nlohmann::ordered_json content_;
};

}
