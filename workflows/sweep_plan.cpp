#include "workflows/sweep_run.h"

#include "workflows/workflow.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

namespace sigmaflow::workflows {

namespace fs = std::filesystem;

namespace {

/// Values given in addition to those that the sweep has.
void add_values(Swept& swept, const Swept& more)
{
    for (const auto& value : more.values)
        if (std::find(swept.values.begin(), swept.values.end(), value) == swept.values.end())
            swept.values.push_back(value);
}

void refuse_twice(const Sweep& sweep)
{
    std::set<std::string> seen;
    for (const Swept& swept : sweep.swept)
        if (!seen.insert(swept.pointer).second)
            throw Error(ErrorKind::usage, "--sweep " + swept.pointer, "is given twice");
    for (const io::Override& setting : sweep.settings)
        if (!seen.insert(setting.pointer).second)
            throw Error(ErrorKind::usage, "--set " + setting.pointer,
                        "is given twice or swept as well");
    if (sweep.repeats > 1 && seen.contains("/suspension/seed"))
        throw Error(ErrorKind::usage, "--repeat", "makes seeds, so they cannot be given as well");
}

/// The sweep of a folder, with what the options add to it.
SweepFolder sweep_to_go_on(const SweepOptions& options)
{
    if (options.out)
        throw Error(ErrorKind::usage, "--out", "cannot be given for the folder of a sweep");
    if (!options.settings.empty())
        throw Error(ErrorKind::usage, "--set", "cannot be changed in a sweep that has begun");
    SweepFolder sweep = read_sweep(options.given);
    for (const std::string& text : options.swept) {
        Swept more = parse_swept(text);
        for (auto& value : more.values) freeze_paths(value, sweep.source.parent_path());
        const auto it =
            std::find_if(sweep.sweep.swept.begin(), sweep.sweep.swept.end(),
                         [&](const Swept& swept) { return swept.pointer == more.pointer; });
        if (it == sweep.sweep.swept.end())
            throw Error(ErrorKind::usage, "--sweep " + more.pointer,
                        "cannot begin in a sweep that has begun, only values can be added");
        add_values(*it, more);
    }
    return sweep;
}

SweepFolder new_sweep(const SweepOptions& options)
{
    const fs::path& file = options.given;
    SweepFolder sweep{
        .path = options.out.value_or(fs::path("out") / (file.stem().string() + "_sweep")),
        .source = fs::absolute(file).lexically_normal(),
        .workflow = frozen_workflow(file),
        .sweep = {},
        .points = {}};
    sweep.sweep.settings = options.settings;
    for (io::Override& setting : sweep.sweep.settings) freeze_paths(setting, file.parent_path());
    for (const std::string& text : options.swept) {
        sweep.sweep.swept.push_back(parse_swept(text));
        for (auto& value : sweep.sweep.swept.back().values) freeze_paths(value, file.parent_path());
    }
    if (sweep.sweep.swept.empty() && options.repeats.value_or(1) == 1)
        throw Error(ErrorKind::usage, "--sweep",
                    "is needed at least once, or --repeat, or the folder of a sweep");
    return sweep;
}

/// Checks points as `run` will, remembers their seeds, and keeps one error of each kind.
class Checker {
public:
    Checker(fs::path file, const Sweep& sweep) : file_(std::move(file)), sweep_(sweep) {}

    void check(const Point& point)
    {
        if (seeds_.contains(point.name)) return;
        seeds_[point.name] = 0;
        try {
            const auto document = io::JsonDocument::read(file_, point.overrides);
            const Workflow workflow = read_workflow(document, file_);
            seeds_[point.name] = workflow.suspension->packing.seed;
            if (sweep_.repeats > 1 && !document.root().has("suspension"))
                throw Error(ErrorKind::usage, "--repeat",
                            "makes seeds of packings, but the workflow has no \"suspension\"");
        } catch (const Errors& errors) {
            for (const Error& error : errors.list()) keep(error, point);
        } catch (const Error& error) {
            if (error.kind() != ErrorKind::input) throw;
            keep(error, point);
        }
    }

    std::uint64_t seed_of(const Point& point)
    {
        check(point);
        return seeds_.at(point.name);
    }

    const std::vector<Error>& errors() const { return errors_; }

private:
    void keep(const Error& error, const Point& point)
    {
        if (said_.insert(error.what()).second)
            errors_.push_back(error.within("point " + point.name));
    }

    fs::path file_;
    const Sweep& sweep_;
    std::map<std::string, std::uint64_t> seeds_;
    std::set<std::string> said_;
    std::vector<Error> errors_;
};

}

SweepFolder planned_sweep(const SweepOptions& options)
{
    std::error_code error;
    const bool goes_on = fs::is_directory(options.given, error);
    SweepFolder sweep = goes_on ? sweep_to_go_on(options) : new_sweep(options);
    sweep.sweep.repeats = options.repeats.value_or(sweep.sweep.repeats);
    refuse_twice(sweep.sweep);
    Checker checker(goes_on ? options.given / frozen_name : options.given, sweep.sweep);
    sweep.points =
        points_of(sweep.sweep, [&](const Point& point) { return checker.seed_of(point); });
    for (const Point& point : sweep.points)
        if (point.repeat == 1) checker.check(point);
    if (!checker.errors().empty()) throw Errors(checker.errors());
    return sweep;
}

}
