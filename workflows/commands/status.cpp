// sigmaflow status
#include "workflows/commands.h"
#include "workflows/json_lines.h"
#include "workflows/run_status.h"

#include <CLI/CLI.hpp>
#include <memory>

namespace sigmaflow::workflows {

namespace {

struct StatusArguments {
    std::string folder;
    bool json = false;
};

Work declare(CLI::App& app)
{
    const auto given = std::make_shared<StatusArguments>();
    app.add_option("DIR", given->folder, "the folder of a run")->required();
    describe_json(app, given->json);
    return [given] {
        const RunStatus status = status_of(given->folder);
        if (given->json)
            print_json(status_json(status));
        else
            print_result(status_text(status));
    };
}

}

Command status_command()
{
    return {
        "status", "what of a run is done, running and left, and what to type next",
        R"(  sigmaflow status out/quickstart                     of a run that goes on, ended or was killed
  sigmaflow status out/quickstart --json              the same as one JSON object)",
        declare};
}

}
