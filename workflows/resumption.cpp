#include "workflows/resumption.h"

#include "workflows/manifest.h"

#include <algorithm>
#include <map>
#include <set>

namespace sigmaflow::workflows {

namespace fs = std::filesystem;

namespace {

struct EarlierRecords {
    std::map<std::string, StepRecord> good;  // by name of the step
    std::map<std::string, std::string> damaged;
};

std::vector<fs::path> record_paths(const RunFolder& folder)
{
    std::vector<fs::path> paths;
    std::error_code none;  // a folder that is only looked at need not exist
    for (const auto& entry : fs::directory_iterator(folder.own_file(""), none))
        if (entry.path().extension() == record_ending) paths.push_back(entry.path());
    std::sort(paths.begin(), paths.end());
    return paths;
}

EarlierRecords earlier_records(const RunFolder& folder)
{
    EarlierRecords result;
    for (const fs::path& path : record_paths(folder)) {
        const std::string name = path.stem().string();
        try {
            StepRecord record = read_record(path);
            if (record.identity.name != name)
                throw Error(ErrorKind::input, path.string(), "belongs to another step");
            result.good.emplace(name, std::move(record));
        } catch (const Error& error) {
            result.damaged[name] = error.what();
        }
    }
    return result;
}

[[noreturn]] void refuse_other_physics(const std::string& what, const std::string& differences)
{
    throw Error(ErrorKind::input, "",
                what + ": " + differences + " (choose another folder with --out, or --force)");
}

/// Why the result of a record cannot be used; empty if it can.
std::string reason_against(const StepRecord& record, const StepIdentity& now,
                           const RunFolder& folder)
{
    const StepIdentity& then = record.identity;
    if (then.key != now.key) {
        if (then.numerics != now.numerics)
            return "it was computed by an earlier version of the numerics";
        const std::string differences = changes(then.parameters, now.parameters);
        return differences.empty() ? "a step before it was changed" : differences;
    }
    for (const ResultFile& file : record.files)
        if (const std::string difference = folder.difference(file); !difference.empty())
            return difference;
    return "";
}

void check_checkpoint(const Resumption& plan)
{
    const StepIdentity& then = plan.checkpoint->step;
    const std::string what = "the interrupted step " + then.name + " cannot go on";
    const auto now = std::find_if(plan.steps.begin(), plan.steps.end(), [&](const PlannedStep& s) {
        return s.identity.name == then.name;
    });
    if (now == plan.steps.end()) refuse_other_physics(what, "the workflow no longer has it");
    if (now->identity.key == then.key) return;
    if (then.numerics != now->identity.numerics)
        throw Error(ErrorKind::missing, "",
                    what + ": it was begun by version " + std::to_string(then.numerics) +
                        " of the numerics, this is " + std::to_string(now->identity.numerics) +
                        "; finish it with the program that began it, or use --force");
    const std::string differences = changes(then.parameters, now->identity.parameters);
    refuse_other_physics(what, differences.empty() ? "a step before it was changed" : differences);
}

}

Resumption plan_resumption(const Workflow& workflow, const RunFolder& folder, bool force)
{
    Resumption plan;
    for (StepIdentity& identity : identities(workflow))
        plan.steps.push_back({std::move(identity), {}, ""});
    EarlierRecords earlier = earlier_records(folder);
    if (force) {
        for (PlannedStep& step : plan.steps)
            if (earlier.good.contains(step.identity.name)) step.reason = "--force";
        return plan;
    }
    std::set<std::string> finished;
    for (const auto& [name, record] : earlier.good) finished.insert(record.identity.key);
    plan.checkpoint = newest_checkpoint(folder, finished, plan.warnings);

    const std::string& suspension = plan.steps.front().identity.suspension;
    const auto require_same = [&](const StepIdentity& then) {
        if (then.suspension != suspension)
            refuse_other_physics("the folder holds a run of another suspension",
                                 changes(then.suspension, suspension));
    };
    if (plan.checkpoint) require_same(plan.checkpoint->step);
    for (const auto& [name, record] : earlier.good) require_same(record.identity);

    for (PlannedStep& step : plan.steps) {
        const std::string& name = step.identity.name;
        if (const auto damaged = earlier.damaged.find(name); damaged != earlier.damaged.end())
            step.reason = damaged->second;
        const auto found = earlier.good.find(name);
        if (found == earlier.good.end()) continue;
        step.reason = reason_against(found->second, step.identity, folder);
        if (step.reason.empty()) step.record = std::move(found->second);
    }
    if (plan.checkpoint) check_checkpoint(plan);
    if (plan.checkpoint && plan.checkpoint->arithmetic != arithmetic())
        plan.warnings.push_back("the checkpoint was made with " + plan.checkpoint->arithmetic +
                                ", this processor computes with " + arithmetic() +
                                ": the run goes on, but not with the same last bits");
    return plan;
}

void remove_unused(const Resumption& plan, const RunFolder& folder)
{
    const auto is_used = [&](const std::string& name) {
        return std::any_of(plan.steps.begin(), plan.steps.end(), [&](const PlannedStep& step) {
            return step.identity.name == name && step.record;
        });
    };
    for (const fs::path& path : record_paths(folder)) {
        const std::string name = path.stem().string();
        if (is_used(name)) continue;
        try {
            for (const ResultFile& file : read_record(path).files) folder.remove(file.name);
        } catch (const Error&) {  // its files are replaced when the step runs
        }
        std::error_code ignored;
        fs::remove(path, ignored);
        if (!plan.checkpoint || plan.checkpoint->step.name != name) folder.remove_leftovers(name);
    }
    if (plan.checkpoint) return;
    for (const std::string& name : stored_steps(folder))
        if (!is_used(name)) folder.remove_leftovers(name);
    remove_checkpoints(folder);
}

}
