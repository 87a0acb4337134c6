// workflows/workflow.h -- a workflow file as checked parameters.
//
//   {"name": "...", "suspension": {...}, "steps": [{"step": "pack"}, {"step": "shear", ...}, ...]}
//
// Reading checks everything that can be checked without computing: keys, types, limits,
// combinations and that every step finds the state or the run that it needs. Errors: missing,
// input.
#pragma once
#include "workflows/step.h"

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sigmaflow::workflows {

struct Workflow {
    std::string name;  // default: the file name without .json
    std::string description;
    std::unique_ptr<Suspension> suspension;  // steps refer to it
    std::vector<Step> steps;

    std::vector<std::string> step_names() const;
    /// All parameters with their defaults filled in: a workflow file that repeats this one.
    nlohmann::ordered_json resolved() const;
    /// The same for a file in any other folder: paths, which count from `folder`, are absolute.
    nlohmann::ordered_json standing_alone(const std::filesystem::path& folder) const;
};

Workflow read_workflow(const std::filesystem::path& path);
Workflow read_workflow(const io::JsonDocument& document, const std::filesystem::path& path);
/// `file` stands for the file in error messages.
Workflow parse_workflow(const std::string& text, const std::string& file);

/// All of the file but the steps.
std::vector<io::Field> workflow_fields(Workflow& workflow, std::string& schema);
/// The parameters of a step, the common ones first, "sweep" last.
std::vector<io::Field> step_fields(Step& step);

}
