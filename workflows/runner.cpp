#include "workflows/runner.h"

#include "io/atomic_file.h"
#include "workflows/manifest.h"
#include "workflows/report.h"
#include "workflows/workflow.h"

#include <chrono>
#include <ostream>

namespace sigmaflow::workflows {

using Json = nlohmann::ordered_json;

namespace {

io::Provenance provenance_of(const Workflow& workflow)
{
    return {{"sigmaflow_version", version()},
            {"seed", std::to_string(workflow.suspension->packing.seed)},
            {"workflow", workflow.resolved().dump()},
            {"libraries", library_versions().dump()}};
}

/// Runs one step; what it found out goes to the summary, how long it took to the manifest.
void run_step(const Step& step, std::size_t number, std::size_t count, Context& context,
              Json& summary, Manifest& manifest)
{
    context.step_name = step.name;
    context.results = Json::object();
    std::string title = "[";
    title += std::to_string(number) + "/" + std::to_string(count) + "] " + step.name;
    context.progress.begin(title);
    const auto start = std::chrono::steady_clock::now();
    try {
        step.run(context);
    } catch (const Error& error) {
        throw error.within(step.pointer + " (" + step.name + ")");
    }
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    Json entry = {{"step", step.kind}};
    entry.update(context.results);
    summary["steps"][step.name] = std::move(entry);
    manifest.add_step(step, taken.count());
    context.progress.end(one_line(summary["steps"][step.name]));
    io::write_file(context.folder.file(summary_name), summary.dump(2) + "\n");
    manifest.write(context.folder, "running");
}

void run_steps(const Workflow& workflow, Context& context, Json& summary, Manifest& manifest)
{
    std::size_t number = 0;
    for (const Step& step : workflow.steps)
        run_step(step, ++number, workflow.steps.size(), context, summary, manifest);
}

}

void run_workflow(const RunOptions& options, std::ostream& results)
{
    const Workflow workflow = read_workflow(options.workflow);
    RunFolder folder(options.out.value_or(std::filesystem::path("out") / options.workflow.stem()),
                     workflow.name);
    Progress progress = Progress::for_stderr(options.quiet);
    Manifest manifest(workflow, options.workflow, options.threads);
    manifest.write(folder, "running");
    progress.note("writing to " + folder.path().string() +
                  (folder.replaces_earlier_run() ? ", in place of an earlier run" : ""));
    Context context{.suspension = *workflow.suspension,
                    .provenance = provenance_of(workflow),
                    .folder = folder,
                    .progress = progress,
                    .threads = options.threads,
                    .state = {},
                    .runs = {},
                    .last_run = {},
                    .step_name = {},
                    .results = {},
                    .problems = {}};
    Json summary = {{"workflow", workflow.name}, {"steps", Json::object()}};
    try {
        run_steps(workflow, context, summary, manifest);
        const std::string& first = context.problems.empty() ? "" : context.problems.front();
        manifest.write(folder, context.problems.empty() ? "complete" : "pictures missing", first);
    } catch (const std::exception& error) {
        progress.clear();
        try {
            manifest.write(folder, "failed", error.what());
        } catch (const Error&) {  // the first error is the one to report
        }
        throw;
    }
    results << table(summary) << "results in " << folder.path().string() << "\n" << std::flush;
    if (!context.problems.empty())
        throw Error(ErrorKind::rendering, "",
                    std::to_string(context.problems.size()) +
                        " pictures could not be drawn, all other results are complete: " +
                        context.problems.front());
}

}
