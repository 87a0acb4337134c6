#include "workflows/validate.h"

#include "io/atomic_file.h"
#include "io/case_file.h"
#include "io/guarded.h"
#include "io/particles_vtp.h"
#include "io/run_file.h"
#include "workflows/checkpoint.h"
#include "workflows/forecast.h"
#include "workflows/step_record.h"
#include "workflows/workflow.h"

#include <algorithm>
#include <array>

namespace sigmaflow::workflows {

namespace {

using Path = std::filesystem::path;

std::string counted(std::size_t number, const std::string& what)
{
    return std::to_string(number) + " " + what + (number == 1 ? "" : "s");
}

std::string describe_json(const Path& path, const std::vector<io::Override>& overrides)
{
    const io::JsonDocument document = io::JsonDocument::read(path, overrides);
    const io::JsonNode root = document.root();
    if (root.find("kind")) return io::describe_case(root);
    if (root.find("steps")) {
        const Workflow workflow = read_workflow(document, path);
        return "workflow, " + counted(workflow.steps.size(), "step") + ", needs about " +
               forecast_text(forecast(workflow));
    }
    throw root.error("is neither a workflow (no \"steps\") nor a case (no \"kind\")");
}

std::string describe_run(const Path& path)
{
    return io::guarded(path, io::limits_for(path), [&] {
        const io::RunSummary run = io::check_run(path);
        return "run, " + counted(run.frames, "frame") + " of " +
               counted(run.particles, "particle") + ", " + counted(run.samples, "sample");
    });
}

std::string describe_vtp(const Path& path)
{
    return io::guarded(path, io::limits_for(path), [&] {
        const io::VtpSummary data = io::check_vtp(path);
        return "VTK polydata, " + counted(data.points, "point") + ", " +
               counted(data.cells, "cell") + ", " + counted(data.arrays, "array");
    });
}

/// A checkpoint or the record of a step.
std::string describe_sealed(const Path& path)
{
    return io::guarded(path, io::limits_for(path), [&] {
        if (path.extension() == record_ending)
            return "record of the finished step " + read_record(path).identity.name;
        const Checkpoint checkpoint = read_checkpoint(path);
        return "checkpoint of the step " + checkpoint.step.name + " at strain " +
               rounded_text(checkpoint.strain) + ", written " + checkpoint.written;
    });
}

/// What a file begins with decides, then its name.
struct Kind {
    std::string_view beginning, extension;
    std::string (*describe)(const Path&);
};

constexpr std::array kinds{
    Kind{"\x89HDF\r\n\x1a\n", ".h5", describe_run},
    Kind{"<?xml", ".vtp", describe_vtp},
    Kind{"<VTKFile", ".vtp", describe_vtp},
    Kind{"sigmaflo", "", describe_sealed},
};

/// Null: JSON.
const Kind* kind_of(const Path& path)
{
    const std::string beginning = io::first_bytes(path, 8);
    for (const Kind& kind : kinds)
        if (beginning.starts_with(kind.beginning)) return &kind;
    for (const Kind& kind : kinds)
        if (!kind.extension.empty() && path.extension() == kind.extension) return &kind;
    return nullptr;
}

}

std::string validate_file(const Path& path, const std::vector<io::Override>& overrides)
{
    const Kind* kind = kind_of(path);
    if (kind && !overrides.empty())
        throw Error(ErrorKind::usage, path.string(), "has no values that --set could change");
    return path.string() + ": " + (kind ? kind->describe(path) : describe_json(path, overrides));
}

}
