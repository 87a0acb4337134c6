// The status of a run for people and for programs.
#include "workflows/checkpoint.h"
#include "workflows/progress.h"
#include "workflows/run_status.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow::workflows {

using Json = nlohmann::ordered_json;

namespace {

std::string percent(const std::optional<double>& share)
{
    return share ? " (" + std::to_string(std::lround(100 * *share)) + " %)" : "";
}

std::string padded(std::string text, std::size_t width)
{
    text.resize(std::max(text.size(), width), ' ');
    return text;
}

std::string state_line(const RunStatus& run)
{
    std::string text = run.folder + ": " + run.state;
    if (run.state == "running") text += ", " + run.owner;
    if (run.state == "killed") text += ": " + run.owner + " ended without a word";
    if (run.state == "unknown")
        text += ": says running, but its host cannot be asked from here (" + run.owner + ")";
    return text + "\n";
}

std::string now_text(const RunStatus& run)
{
    std::string text;
    if (run.strain) text += ", strain " + rounded_text(*run.strain) + percent(run.share);
    if (run.step_seconds_left) text += ", " + duration_text(*run.step_seconds_left) + " left";
    return text;
}

template <class T>
Json or_null(const std::optional<T>& value)
{
    return value ? Json(*value) : Json(nullptr);
}

}

std::string status_text(const RunStatus& run)
{
    std::string text = state_line(run);
    if (!run.started.empty())
        text += "started " + run.started + (run.ended.empty() ? "" : ", ended " + run.ended) + "\n";
    std::size_t widest = 4;
    for (const StepStatus& step : run.steps) widest = std::max(widest, step.name.size());
    for (const StepStatus& step : run.steps) {
        text += "  " + padded(step.name, widest + 2) + padded(step.state, 13);
        if (step.wall_seconds) text += padded(duration_text(*step.wall_seconds), 14);
        text += step.outcome;
        if (step.state == "running") text += now_text(run);
        while (text.back() == ' ') text.pop_back();
        text += "\n";
    }
    if (const auto& stored = run.checkpoint)
        text += "last checkpoint: " + stored->step + " at strain " + rounded_text(stored->strain) +
                percent(stored->share) + ", " + stored->written + "\n";
    if (!run.error.empty()) text += "error: " + run.error + "\n";
    return text + "next: " + run.next + "\n";
}

Json status_json(const RunStatus& run)
{
    Json steps = Json::array();
    for (const StepStatus& step : run.steps)
        steps.push_back({{"name", step.name},
                         {"step", step.kind},
                         {"state", step.state},
                         {"outcome", step.outcome},
                         {"wall_seconds", or_null(step.wall_seconds)}});
    Json checkpoint = nullptr;
    if (const auto& stored = run.checkpoint)
        checkpoint = {{"step", stored->step},
                      {"written", stored->written},
                      {"strain", stored->strain},
                      {"share", or_null(stored->share)}};
    return {{"event", "status"},
            {"folder", run.folder},
            {"state", run.state},
            {"workflow", run.workflow},
            {"workflow_file", run.workflow_file},
            {"owner", run.owner},
            {"started", run.started},
            {"ended", run.ended},
            {"error", run.error},
            {"steps", steps},
            {"checkpoint", checkpoint},
            {"strain", or_null(run.strain)},
            {"share", or_null(run.share)},
            {"step_seconds_left", or_null(run.step_seconds_left)},
            {"next", run.next}};
}

}
