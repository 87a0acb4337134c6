#include "workflows/runner.h"

#include "io/atomic_file.h"
#include "workflows/forecast.h"
#include "workflows/json_lines.h"
#include "workflows/manifest.h"
#include "workflows/parts.h"
#include "workflows/report.h"
#include "workflows/resumption.h"
#include "workflows/workflow.h"

#include <chrono>
#include <functional>
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

/// What a finished step hands on, taken from its record.
void hand_on(StepRecord record, Context& context)
{
    if (record.state) context.state = std::move(*record.state);
    if (record.run) {
        if (record.run->file.empty())
            record.run->file = context.folder.path() / record.identity.name / run_name;
        context.runs.push_back(std::move(*record.run));
    }
    context.last_run = record.last_run;
    context.results = Json::parse(record.results);
}

/// Runs one step and makes its record, unless a picture is missing: then it runs again next time.
StepRecord run_step(const Step& step, const StepIdentity& identity, Context& context)
{
    const std::size_t runs = context.runs.size(), problems = context.problems.size();
    context.results = Json::object();
    const auto start = std::chrono::steady_clock::now();
    try {
        step.run(context);
    } catch (const Error& error) {
        if (error.kind() == ErrorKind::interrupted) throw;
        throw error.within(step.pointer + " (" + step.name + ")");
    }
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    StepRecord record{.identity = identity,
                      .results = context.results.dump(),
                      .wall_seconds = taken.count(),
                      .files = context.folder.take_results(),
                      .state = {},
                      .run = {},
                      .last_run = context.last_run};
    if (step.changes_state) record.state = context.state;
    if (context.runs.size() > runs) {
        record.run = context.runs.back();
        if (step.inputs.empty()) record.run->file.clear();  // the folder may be moved
    }
    if (context.problems.size() == problems) write_record(context.folder, record);
    remove_checkpoints(context.folder);
    remove_parts(context.folder, step.name);
    context.folder.remove(step.name + "/" + journal_name);  // only now: checkpoints need it
    return record;
}

/// Where the events go, nowhere without --json.
using Tell = std::function<void(const Json&)>;

Json event(const char* name, const Json& which, const Json& more = Json::object())
{
    Json result = {{"event", name}};
    result.update(which);
    result.update(more);
    return result;
}

Progress::Listener told(const Tell& tell)
{
    return [&tell](std::string_view what, const std::string& text, double fraction, double left) {
        if (what == "progress")
            tell({{"event", what},
                  {"fraction", fraction},
                  {"seconds_left", left >= 0 ? Json(left) : Json(nullptr)},
                  {"details", text}});
        else
            tell({{"event", what}, {"text", text}});
    };
}

/// All steps; what they found out goes to the summary, how long they took to the manifest.
void run_steps(const Workflow& workflow, Resumption plan, Context& context, Json& summary,
               Manifest& manifest, const Tell& tell)
{
    const std::size_t count = workflow.steps.size();
    for (std::size_t k = 0; k < count; ++k) {
        const Step& step = workflow.steps[k];
        PlannedStep& planned = plan.steps[k];
        context.step_name = step.name;
        std::string title = "[";
        title += std::to_string(k + 1) + "/" + std::to_string(count) + "] " + step.name;
        context.progress.begin(title);
        const bool done = planned.record.has_value();
        const Json which = {
            {"number", k + 1}, {"of", count}, {"name", step.name}, {"step", step.kind}};
        const auto began = std::chrono::steady_clock::now();
        tell(event("step_begin", which));
        if (done) {
            manifest.add_step(*planned.record);
            hand_on(std::move(*planned.record), context);
            context.folder.remove(step.name + "/" + journal_name);
        } else {
            const bool goes_on =
                plan.checkpoint && plan.checkpoint->step.name == planned.identity.name;
            if (goes_on)
                context.progress.note(title + ": goes on from strain " +
                                      rounded_text(plan.checkpoint->strain) + ", stored " +
                                      plan.checkpoint->written);
            else if (!planned.reason.empty())
                context.progress.note(title + ": again, " + planned.reason);
            context.keeper.stop_if_asked();
            context.keeper.begin(planned.identity,
                                 goes_on ? std::move(plan.checkpoint) : std::nullopt);
            manifest.add_step(run_step(step, planned.identity, context));
        }
        context.finished[step.name] = context.results;
        Json entry = {{"step", step.kind}};
        entry.update(context.results);
        summary["steps"][step.name] = std::move(entry);
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - began;
        tell(event("step_end", which,
                   {{"seconds", taken.count()},
                    {"from_earlier_run", done},
                    {"results", context.results}}));
        const std::string line = one_line(summary["steps"][step.name]);
        context.progress.end(done ? line + ", from an earlier run" : line);
        // what an earlier run says of the steps to come is out of date
        const bool next_runs = k + 1 < count && !plan.steps[k + 1].record;
        if (!done || next_runs) {
            io::write_file(context.folder.path() / summary_name, summary.dump(2) + "\n");
            manifest.write(context.folder, "running");
        }
    }
    io::write_file(context.folder.path() / summary_name, summary.dump(2) + "\n");
}

}

void run_workflow(const RunOptions& options, std::ostream& results)
{
    const Interruption interruption(options.wall_time);
    const io::JsonDocument document = io::JsonDocument::read(options.workflow, options.overrides);
    const Workflow workflow = read_workflow(document, options.workflow);
    RunFolder folder(options.out.value_or(std::filesystem::path("out") / options.workflow.stem()),
                     workflow.name);
    Resumption plan = plan_resumption(workflow, folder, options.force);
    const Forecast needed = forecast(workflow, &plan);
    check_room(needed, room_here(folder.path()), document.root(), folder.path());
    remove_unused(plan, folder);
    remove_other_parts(folder, options.force ? std::vector<std::string>{} : workflow.step_names());
    const Tell tell = options.json ? Tell(print_json) : Tell([](const Json&) {});
    Progress progress = Progress::for_stderr(options.quiet || options.json);
    if (options.json) progress.tell(told(tell));
    Manifest manifest(workflow, options.workflow, options.overrides, options.threads);
    io::write_file(folder.path() / resolved_name,
                   workflow.standing_alone(options.workflow.parent_path()).dump(2) + "\n");
    manifest.write(folder, "running");
    tell({{"event", "start"},
          {"workflow", workflow.name},
          {"folder", folder.path().string()},
          {"steps", workflow.step_names()},
          {"memory_bytes", needed.memory},
          {"disk_bytes", needed.disk}});
    progress.note("writing to " + folder.path().string());
    if (needed.disk > 0) progress.note("needs about " + forecast_text(needed));
    for (const std::string& warning : plan.warnings) progress.warn(warning);
    Keeper keeper(folder, interruption, options.checkpoint_interval);
    Context context{.suspension = *workflow.suspension,
                    .provenance = provenance_of(workflow),
                    .folder = folder,
                    .progress = progress,
                    .keeper = keeper,
                    .threads = options.threads,
                    .state = {},
                    .runs = {},
                    .last_run = {},
                    .step_name = {},
                    .results = {},
                    .problems = {},
                    .finished = {}};
    Json summary = {{"workflow", workflow.name}, {"steps", Json::object()}};
    try {
        run_steps(workflow, std::move(plan), context, summary, manifest, tell);
        const std::string& first = context.problems.empty() ? "" : context.problems.front().text;
        manifest.write(folder, context.problems.empty() ? "complete" : "pictures missing", first);
    } catch (const std::exception& error) {
        progress.clear();
        const auto* own = dynamic_cast<const Error*>(&error);
        const bool interrupted = own && own->kind() == ErrorKind::interrupted;
        try {
            manifest.write(folder, interrupted ? "interrupted" : "failed", error.what());
        } catch (const Error&) {  // the first error is the one to report
        }
        throw;
    }
    if (!options.json)
        results << table(summary) << "results in " << folder.path().string() << "\n" << std::flush;
    if (!context.problems.empty())
        throw Error(ErrorKind::rendering, "",
                    std::to_string(context.problems.size()) +
                        " pictures could not be drawn, all other results are complete: " +
                        context.problems.front().text);
}

}
