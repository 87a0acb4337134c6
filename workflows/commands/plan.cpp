// sigmaflow plan
#include "workflows/commands.h"
#include "workflows/json_lines.h"
#include "workflows/run_plan.h"

#include <CLI/CLI.hpp>
#include <memory>

namespace sigmaflow::workflows {

namespace {

struct PlanArguments {
    PlanOptions options;
    std::string out;
    bool json = false;
};

Work declare(CLI::App& app)
{
    const auto given = std::make_shared<PlanArguments>();
    app.add_option("WORKFLOW.json", given->options.workflow, "the workflow")->required();
    const CLI::Option* out = app.add_option(
        "--out", given->out, "folder of the results, default out/<name of the workflow file>");
    const auto overrides = declare_overrides(app);
    app.add_flag("--force", given->options.force, "as of run: all steps anew");
    app.add_option("--threads", given->options.threads, "as of run")
        ->check(CLI::Range(1, 256))
        ->default_val(1);
    describe_json(app, given->json);
    return [given, overrides, out] {
        given->options.overrides = overrides();
        if (out->count()) {
            need_text("--out", given->out, "must name a folder");
            given->options.out = given->out;
        }
        const RunPlan plan = plan_run(given->options);
        if (given->json)
            print_json(plan_json(plan));
        else
            print_result(plan_text(plan));
    };
}

}

Command plan_command()
{
    return {
        "plan", "which steps would run and why; time, memory and disk they need",
        R"(  sigmaflow plan my_flow.json                         writes nothing, computes for a second at most
  sigmaflow plan my_flow.json --out results/phi_0.56  what is left of the run in that folder)",
        declare};
}

}
