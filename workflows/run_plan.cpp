#include "workflows/run_plan.h"

#include "workflows/folder_owner.h"
#include "workflows/past_run.h"
#include "workflows/progress.h"
#include "workflows/resumption.h"

#include <algorithm>
#include <numeric>

namespace sigmaflow::workflows {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

void require_this_workflow(const fs::path& folder, const std::string& workflow)
{
    std::error_code error;
    if (!fs::exists(folder / manifest_name, error)) {
        if (fs::exists(folder, error) && !fs::is_empty(folder, error) &&
            !fs::is_directory(folder / own_folder, error))
            throw Error(ErrorKind::file, folder.string(),
                        "is not empty and holds no earlier run of sigmaflow; choose another folder "
                        "with --out");
        return;
    }
    if (const std::string title = read_past_run(folder).title(); title != workflow)
        throw Error(ErrorKind::file, folder.string(),
                    "holds a run of another workflow, " + io::in_quotes(title) +
                        "; choose another folder with --out");
}

/// The nearest folder above that exists: where the disk will be asked.
fs::path existing(fs::path folder)
{
    std::error_code error;
    folder = fs::absolute(folder, error);
    while (!fs::exists(folder, error) && folder.has_relative_path()) folder = folder.parent_path();
    return folder;
}

double end_of(const std::string& parameters)
{
    const Json json = Json::parse(parameters);
    for (const char* key : {"strain", "maximum_strain"})
        if (json.contains(key) && json[key].is_number()) return json[key];
    return 0;
}

ForeseenStep foreseen(const PlannedStep& planned, const Resumption& resumption, StepCost cost)
{
    ForeseenStep step{planned.identity.name, planned.identity.kind, true, "new", std::move(cost)};
    const auto& stored = resumption.checkpoint;
    if (planned.record) {
        step.runs = false;
        step.why = "is finished";
        step.cost.seconds = step.cost.at_most = 0;
        step.cost.jams = false;
    } else if (stored && stored->step.name == step.name) {
        step.why = "goes on from strain " + rounded_text(stored->strain);
        const double end = end_of(planned.identity.parameters);
        const double left = end > 0 ? std::clamp(1 - stored->strain / end, 0., 1.) : 1;
        step.cost.seconds *= left;
        step.cost.at_most *= left;
    } else if (!planned.reason.empty()) {
        step.why = planned.reason;
    }
    return step;
}

double sum(const std::vector<ForeseenStep>& steps, double StepCost::*value)
{
    return std::accumulate(
        steps.begin(), steps.end(), 0.,
        [&](double all, const ForeseenStep& step) { return all + step.cost.*value; });
}

std::string time_text(const StepCost& cost)
{
    if (cost.at_most <= 0) return "-";
    std::string text = cost.seconds < 0.5 ? "< 1 s" : duration_text(cost.seconds);
    if (cost.at_most > 1.2 * cost.seconds) text += ", at most " + duration_text(cost.at_most);
    if (cost.jams) text += " (less if it jams)";
    return text;
}

std::string padded(std::string text, std::size_t width)
{
    text.resize(std::max(text.size(), width), ' ');
    return text;
}

}

double RunPlan::seconds() const
{
    return sum(steps, &StepCost::seconds);
}

double RunPlan::at_most() const
{
    return sum(steps, &StepCost::at_most);
}

bool RunPlan::fits() const
{
    return !(room.memory && needed.memory > *room.memory) &&
           !(room.disk && needed.disk > *room.disk);
}

RunPlan plan_run(const PlanOptions& options)
{
    const Workflow workflow = read_workflow(
        io::JsonDocument::read(options.workflow, options.overrides), options.workflow);
    const fs::path path = options.out.value_or(fs::path("out") / options.workflow.stem());
    require_this_workflow(path, workflow.name);
    const RunFolder folder = RunFolder::to_read(path);
    const Resumption resumption = plan_resumption(workflow, folder, options.force);
    RunPlan plan;
    plan.workflow = workflow.name;
    plan.folder = path.string();
    if (is_written(path) == Writing::yes) plan.writer = read_owner(path).text;
    const bool runs = std::any_of(resumption.steps.begin(), resumption.steps.end(),
                                  [](const PlannedStep& step) { return !step.record; });
    const auto costs =
        cost(workflow, runs ? machine_factor(*workflow.suspension) : 1, options.threads);
    for (std::size_t k = 0; k < resumption.steps.size(); ++k)
        plan.steps.push_back(foreseen(resumption.steps[k], resumption, costs[k]));
    plan.warnings = resumption.warnings;
    plan.needed = forecast(workflow, &resumption);
    plan.room = room_here(existing(path));
    return plan;
}

std::string plan_text(const RunPlan& plan)
{
    std::string text = plan.workflow + ", results in " + plan.folder + "\n";
    if (!plan.writer.empty()) text += plan.writer + " is writing to this folder\n";
    for (const std::string& warning : plan.warnings) text += "warning: " + warning + "\n";
    std::size_t name = 4, time = 4;
    for (const ForeseenStep& step : plan.steps) {
        name = std::max(name, step.name.size());
        time = std::max(time, time_text(step.cost).size());
    }
    for (const ForeseenStep& step : plan.steps)
        text += "  " + padded(step.name, name + 2) + padded(step.runs ? "runs" : "", 6) +
                padded(time_text(step.cost), time + 2) + step.why + "\n";
    const StepCost all{"", plan.seconds(), plan.at_most(), false};
    if (all.at_most <= 0) return text + "nothing to do\n";
    text += "about " + time_text(all) + " on this machine if it is idle, " +
            forecast_text(plan.needed) + "\n";
    if (!plan.fits()) text += "this machine has less left: the run would be refused\n";
    return text;
}

Json plan_json(const RunPlan& plan)
{
    const auto known = [](const std::optional<double>& value) {
        return value ? Json(*value) : Json(nullptr);
    };
    Json steps = Json::array();
    for (const ForeseenStep& step : plan.steps)
        steps.push_back({{"name", step.name},
                         {"step", step.kind},
                         {"runs", step.runs},
                         {"why", step.why},
                         {"seconds", step.cost.seconds},
                         {"at_most_seconds", step.cost.at_most},
                         {"may_jam", step.cost.jams}});
    return {{"event", "plan"},
            {"workflow", plan.workflow},
            {"folder", plan.folder},
            {"writer", plan.writer.empty() ? Json(nullptr) : Json(plan.writer)},
            {"steps", steps},
            {"seconds", plan.seconds()},
            {"at_most_seconds", plan.at_most()},
            {"memory_bytes", plan.needed.memory},
            {"disk_bytes", plan.needed.disk},
            {"memory_left_bytes", known(plan.room.memory)},
            {"disk_left_bytes", known(plan.room.disk)},
            {"fits", plan.fits()},
            {"warnings", plan.warnings}};
}

}
