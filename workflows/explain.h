// workflows/explain.h -- what a workflow can say, told from the declared parameters.
#pragma once
#include <string>
#include <vector>

namespace sigmaflow::workflows {

/// "": all steps in one line each, the workflow and the suspension. A step, "suspension", "model"
/// or "workflow": its parameters with unit, default, limits and meaning. "shear.stress",
/// "model.debye_length": one parameter. A parameter alone: everywhere it is known.
/// Errors: usage (no such step or parameter, with the nearest name).
std::string explain(const std::string& what = "");

/// All of it as one Markdown page: workflows/reference.md.
std::string reference_page();

/// What explain() knows: steps and the like, and "step.parameter".
std::vector<std::string> explained_names();

}
