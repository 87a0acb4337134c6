// sigmaflow sweep
#include "workflows/sweep_run.h"

#include "workflows/commands.h"
#include "workflows/interruption.h"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

namespace sigmaflow::workflows {

namespace {

struct SweepArguments {
    SweepOptions options;
    std::string out, wall_time, engine;
    int repeats = 1;
    bool no_submit = false;
};

Engine engine_named(const std::string& name)
{
    return name == "slurm"       ? Engine::slurm
           : name == "snakemake" ? Engine::snakemake
                                 : Engine::local;
}

void declare_what(CLI::App& app, SweepArguments& given)
{
    SweepOptions& options = given.options;
    app.add_option("WORKFLOW.json|DIR", options.given, "the workflow, or the folder of a sweep")
        ->required();
    app.add_option("--sweep", options.swept,
                   "PTR=VALUES: a parameter by its JSON pointer and its values, a,b,c or "
                   "from:to:count or from:to:count:log; several: all combinations")
        ->allow_extra_args(false);
    app.add_option("--repeat", given.repeats, "runs of every point, each with a seed of its own")
        ->check(CLI::Range(1, 10'000));
    app.add_option("--out", given.out,
                   "folder of the sweep, default out/<name of the workflow file>_sweep. An earlier "
                   "sweep of the same kind in it goes on, with more values if there are some");
    app.add_option("--y", options.quantity,
                   "column of the table that is drawn, default the viscosity of the last run");
}

void declare_how(CLI::App& app, SweepArguments& given)
{
    SweepOptions& options = given.options;
    app.add_option("--engine", given.engine,
                   "local: processes on this machine; slurm: a job array; snakemake: a "
                   "Snakefile. Default: local, or slurm where it was submitted before")
        ->check(CLI::IsMember({"local", "slurm", "snakemake"}));
    app.add_option("--jobs", options.jobs,
                   "points at a time, default: as many as cores and memory allow (Slurm decides "
                   "itself)")
        ->check(CLI::Range(1, 100'000));
    app.add_option("--threads", options.threads, "threads of every point")
        ->check(CLI::Range(1, 256))
        ->default_val(1);
    app.add_option("--checkpoint-interval", options.checkpoint_interval,
                   "seconds between two checkpoints of a point")
        ->check(CLI::Range(0., 1e6))
        ->default_val(30);
    app.add_option("--max-walltime", given.wall_time,
                   "all points store checkpoints in good time before, exit code 3, e.g. 90m or 2h");
    app.add_option("--slurm-options", options.slurm_options,
                   "options for sbatch, as \"--partition=long --time=2:00:00\"");
    app.add_flag("--no-submit", given.no_submit, "write the job of Slurm, do not submit it");
    app.add_flag("-q,--quiet", options.quiet, "no progress, only results and errors");
}

Work declare(CLI::App& app)
{
    const auto given = std::make_shared<SweepArguments>();
    declare_what(app, *given);
    const auto settings = declare_overrides(app);
    declare_how(app, *given);
    return [given, settings, &app] {
        SweepOptions& chosen = given->options;
        chosen.settings = settings();
        if (app.count("--out")) {
            need_text("--out", given->out, "must name a folder");
            chosen.out = given->out;
        }
        if (app.count("--repeat")) chosen.repeats = given->repeats;
        if (app.count("--max-walltime")) {
            chosen.wall_time = seconds_of(given->wall_time);
            if (!chosen.wall_time)
                throw Error(ErrorKind::usage, "--max-walltime",
                            "must be a time as 5400, 90m, 2h or D-HH:MM:SS, got \"" +
                                given->wall_time + "\"");
        }
        if (app.count("--engine")) chosen.engine = engine_named(given->engine);
        chosen.submit = !given->no_submit;
        if (chosen.engine != Engine::slurm && (given->no_submit || app.count("--slurm-options")))
            throw Error(ErrorKind::usage, given->no_submit ? "--no-submit" : "--slurm-options",
                        "needs --engine slurm");
        run_sweep(chosen, std::cout);
        print_result("");
    };
}

}

Command sweep_command()
{
    return {
        "sweep", "run a workflow for many values of its parameters, or what is left of it",
        R"(  sigmaflow sweep flow.json --sweep /steps/2/stress=0.5,1,2 --sweep /suspension/volume_fraction=0.54:0.58:5
                                                      15 runs in out/flow_sweep, a table and a figure
  sigmaflow sweep flow.json --sweep /steps/2/stress=0.1:10:7:log --repeat 5 --jobs 4
                                                      7 stresses in equal ratios, 5 seeds each
  sigmaflow sweep out/flow_sweep                      goes on with what is not complete
  sigmaflow sweep out/flow_sweep --sweep /steps/2/stress=20
                                                      one more value
  sigmaflow sweep flow.json --sweep /steps/2/stress=1,2 --engine slurm --slurm-options "--time=2:00:00"
                                                      a job array, one point a task
  sigmaflow collect out/flow_sweep                    table and figure of what there is so far)",
        declare};
}

}
