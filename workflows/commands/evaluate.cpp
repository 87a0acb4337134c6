// sigmaflow evaluate
#include "io/case_file.h"
#include "workflows/commands.h"

#include <CLI/CLI.hpp>
#include <memory>

namespace sigmaflow::workflows {

namespace {

Work declare(CLI::App& app)
{
    const auto file = std::make_shared<std::string>();
    app.add_option("CASE.json", *file, "the configuration")->required();
    return [file] { print_result(io::evaluate_case(*file)); };
}

}

Command evaluate_command()
{
    return {"evaluate", "evaluate one configuration, print velocities and stress as JSON",
            R"(  sigmaflow evaluate case.json
  sigmaflow evaluate out/quickstart/shear/state.json  the last state of a run)",
            declare};
}

}
