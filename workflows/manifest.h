// workflows/manifest.h -- manifest.json: what was run, by what, where, and which files it made.
#pragma once
#include "workflows/step_record.h"

#include <nlohmann/json.hpp>
#include <string>

namespace sigmaflow::workflows {

/// Version of this program.
std::string version();

/// Of this machine.
std::string host_name();

/// {"eigen": "3.4.0", "vtk": "9.1.0", ...}
nlohmann::ordered_json library_versions();

/// What the last bits of results depend on: the vector instructions in use and the kernel of BLAS.
std::string arithmetic();

/// Now in ISO 8601, UTC, e.g. 2015-05-26T09:30:00Z.
std::string utc_now();

/// The text of a manifest with its seal as the last key: the checksum of everything before it, so
/// that a change anywhere in the file is noticed.
std::string with_seal(const nlohmann::ordered_json& manifest);
/// Is the text what with_seal has made?
bool seal_holds(std::string_view manifest_text);

class Manifest {
public:
    Manifest(const Workflow& workflow, const std::filesystem::path& workflow_file,
             const std::vector<io::Override>& overrides, int threads);

    /// A finished step with its files.
    void add_step(const StepRecord& record);
    /// With the checksums of summary.json and resolved.json as they are now. Status: running,
    /// complete, pictures missing, interrupted, failed. Errors: file, no_space.
    void write(const RunFolder& folder, const std::string& status, const std::string& error = "");

private:
    nlohmann::ordered_json content_;
};

}
