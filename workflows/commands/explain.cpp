// sigmaflow explain, sigmaflow schema
#include "workflows/explain.h"

#include "workflows/commands.h"
#include "workflows/schema.h"

#include <CLI/CLI.hpp>
#include <memory>

namespace sigmaflow::workflows {

namespace {

struct ExplainArguments {
    std::string what;
    bool markdown = false;
};

Work declare_explain(CLI::App& app)
{
    const auto given = std::make_shared<ExplainArguments>();
    app.add_option("STEP[.PARAMETER]", given->what,
                   "a step, \"suspension\", \"model\", a parameter; default: all steps");
    app.add_flag("--markdown", given->markdown, "the whole reference as one Markdown page");
    return [given] { print_result(given->markdown ? reference_page() : explain(given->what)); };
}

Work declare_schema(CLI::App&)
{
    return [] { print_result(workflow_schema_text()); };
}

}

Command explain_command()
{
    return {"explain", "steps and parameters: unit, default, allowed range, meaning",
            R"(  sigmaflow explain                                   all steps
  sigmaflow explain shear                             the parameters of one step
  sigmaflow explain shear.stress                      one parameter
  sigmaflow explain debye_length                      a parameter wherever it is known)",
            declare_explain};
}

Command schema_command()
{
    return {
        "schema", "the JSON Schema of workflow files, for editors and validators",
        R"(  sigmaflow schema > workflow.schema.json             then "$schema": "workflow.schema.json" in a workflow)",
        declare_schema};
}

}
