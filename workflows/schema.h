// workflows/schema.h -- the JSON Schema of workflow files, made from the declared parameters.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace sigmaflow::workflows {

inline constexpr const char* schema_name = "workflow.schema.json";

/// Draft 2020-12. Editors complete keys and words with it and show units, limits and meanings
/// (name the file in "$schema"); any validator can use it. It cannot say what several values mean
/// together: that a step finds its run, or that names differ.
nlohmann::ordered_json workflow_schema();

/// As the file workflows/workflow.schema.json.
std::string workflow_schema_text();

}
