// sigmaflow init
#include "workflows/init.h"

#include "workflows/commands.h"

#include <CLI/CLI.hpp>
#include <memory>

namespace sigmaflow::workflows {

namespace {

Work declare(CLI::App& app)
{
    const auto file = std::make_shared<std::string>("my_flow.json");
    app.add_option("FILE.json", *file, "the workflow to write")->capture_default_str();
    return [file] {
        write_first_workflow(*file);
        print_result(*file + "\n");
        print_hint("next: sigmaflow run " + *file +
                   "; sigmaflow explain tells what else it can say");
    };
}

}

Command init_command()
{
    return {"init", "write a commented workflow to start from, and its schema for editors",
            R"(  sigmaflow init                                      my_flow.json
  sigmaflow init studies/thickening.json)",
            declare};
}

}
