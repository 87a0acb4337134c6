// sigmaflow run
#include "engine/error.h"
#include "workflows/commands.h"
#include "workflows/interruption.h"
#include "workflows/runner.h"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

namespace sigmaflow::workflows {

namespace {

struct RunArguments {
    RunOptions options;
    std::string out, wall_time;
};

Work declare(CLI::App& app)
{
    const auto given = std::make_shared<RunArguments>();
    RunOptions& options = given->options;
    app.add_option("WORKFLOW.json", options.workflow, "the workflow")->required();
    const CLI::Option* out = app.add_option(
        "--out", given->out,
        "folder for the results, default out/<name of the workflow file>. An earlier run of the "
        "same workflow in it goes on where it ended, any other folder must be empty");
    app.add_flag("--force", options.force,
                 "run all steps anew, even if the folder has their results or a checkpoint");
    app.add_option("--checkpoint-interval", options.checkpoint_interval,
                   "seconds between two checkpoints; 0: after every step")
        ->check(CLI::Range(0., 1e6))
        ->default_val(30);
    const CLI::Option* wall_time = app.add_option(
        "--max-walltime", given->wall_time,
        "store a checkpoint and end with exit code 3 in good time before, e.g. 90m, 2h "
        "or 1-12:00:00");
    app.add_option("--threads", options.threads,
                   "threads of each evaluation, worth it from some thousand particles on; results "
                   "do not depend on it")
        ->check(CLI::Range(1, 256))
        ->default_val(1);
    app.add_flag("-q,--quiet", options.quiet, "no progress, only results and errors");
    return [given, out, wall_time] {
        RunOptions& chosen = given->options;
        if (out->count()) {
            need_text("--out", given->out, "must name a folder");
            chosen.out = given->out;
        }
        if (wall_time->count()) {
            chosen.wall_time = seconds_of(given->wall_time);
            if (!chosen.wall_time)
                throw Error(ErrorKind::usage, "--max-walltime",
                            "must be a time as 5400, 90m, 2h or D-HH:MM:SS, got \"" +
                                given->wall_time + "\"");
        }
        run_workflow(chosen, std::cout);
        print_result("");
    };
}

}

Command run_command()
{
    return {"run", "run a workflow, or what is left of it",
            R"(  sigmaflow run workflows/quickstart.json             results in out/quickstart
  sigmaflow run my_flow.json --out results/phi_0.56   results in a folder of your choice
  sigmaflow run my_flow.json --max-walltime 2h        stops in time; the same command goes on)",
            declare};
}

}
