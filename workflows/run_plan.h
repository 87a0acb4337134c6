// workflows/run_plan.h -- what `sigmaflow run` would do, without doing it.
//
// Reads the folder as a run would (workflows/resumption.h), but makes nothing and takes no lock.
// Errors: those of the run, as far as they can be foreseen: missing, input (also: another
// suspension or an interrupted step whose parameters have changed), file (another workflow's
// folder).
#pragma once
#include "io/json_override.h"
#include "workflows/cost.h"
#include "workflows/forecast.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace sigmaflow::workflows {

struct PlanOptions {
    std::filesystem::path workflow;
    std::vector<io::Override> overrides = {};
    std::optional<std::filesystem::path> out;
    bool force = false;
    int threads = 1;
};

struct ForeseenStep {
    std::string name, kind;
    bool runs = true;
    std::string why;  // "new", "stress was 2, is 3", "goes on from strain 1.5", "is finished"
    StepCost cost;    // of what is left; 0 if it does not run
};

struct RunPlan {
    std::string workflow, folder;
    std::string writer;  // who is writing to the folder now; empty: nobody
    std::vector<ForeseenStep> steps;
    std::vector<std::string> warnings;
    Forecast needed;
    Room room;

    double seconds() const;
    double at_most() const;
    bool fits() const;  // memory and disk
};

RunPlan plan_run(const PlanOptions& options);

std::string plan_text(const RunPlan& plan);
nlohmann::ordered_json plan_json(const RunPlan& plan);

}
