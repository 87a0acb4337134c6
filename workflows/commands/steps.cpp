// sigmaflow steps
#include "workflows/commands.h"
#include "workflows/help.h"

#include <CLI/CLI.hpp>
#include <memory>

namespace sigmaflow::workflows {

namespace {

Work declare(CLI::App& app)
{
    const auto step = std::make_shared<std::string>();
    app.add_option("STEP", *step, "a step; default: all");
    return [step] { print_result(steps_help(*step)); };
}

}

Command steps_command()
{
    return {
        "steps", "explain steps and parameters",
        R"(  sigmaflow steps                                     all steps, the suspension and the model
  sigmaflow steps shear                               the parameters of one step)",
        declare};
}

}
