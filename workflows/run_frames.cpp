#include "workflows/run_frames.h"

#include "io/guarded.h"
#include "io/run_file.h"
#include "io/run_journal.h"
#include "workflows/run_folder.h"

namespace sigmaflow::workflows {

namespace fs = std::filesystem;

namespace {

std::optional<fs::path> stored_file(const PastRun& run, const std::string& step)
{
    if (!is_inside(step)) return std::nullopt;
    for (const char* name : {run_name, journal_name}) {
        std::error_code error;
        const fs::path path = run.folder / step / name;
        if (fs::is_regular_file(path, error)) return path;
    }
    return std::nullopt;
}

/// In a process of its own at first: HDF5 can crash on a damaged file.
RunFrames finished_frames(const fs::path& path)
{
    io::guarded(path, io::limits_for(path), [&] {
        io::check_run(path);
        return std::string();
    });
    io::StoredRun stored = io::read_run(path);
    return {std::move(stored.frames), stored.control};
}

/// A journal says nothing about the control; the workflow does.
Control planned_control(const PastStep& step, const Sample& sample)
{
    const auto number = [&](const char* key) {
        return step.parameters.contains(key) && step.parameters[key].is_number();
    };
    if (number("rate")) return ImposedRate{step.parameters["rate"].get<double>()};
    return ImposedStress{number("stress") ? step.parameters["stress"].get<double>()
                                          : sample.shear_stress};
}

RunFrames frames_so_far(const fs::path& path, const PastStep& step)
{
    RunFrames frames;
    try {
        io::read_journal_so_far(path, {[](const Sample&, bool) {},
                                       [&](const Frame& frame) { frames.list.push_back(frame); }});
    } catch (const Error& error) {
        throw error.where().empty() ? error.within(path.string()) : error;
    }
    if (!frames.list.empty()) frames.control = planned_control(step, frames.list.front().sample);
    return frames;
}

}

const PastStep& step_with_frames(const PastRun& run, const std::string& of)
{
    std::string known;
    const PastStep* last = nullptr;
    for (const PastStep& step : run.steps) {
        if (step.name == of && stored_file(run, of)) return step;
        if (!stored_file(run, step.name)) continue;
        known += (known.empty() ? "" : ", ") + step.name;
        if (step.kind == "shear" || !last || last->kind != "shear") last = &step;
    }
    if (!last)
        throw Error(ErrorKind::input, run.folder.string(),
                    "has no stored frames yet: no step that shears has begun");
    if (!of.empty())
        throw Error(ErrorKind::usage, "--of",
                    "must be a step with stored frames: " + known + ", got \"" + of + "\"");
    return *last;
}

RunFrames read_frames(const PastRun& run, const PastStep& step)
{
    const fs::path path = *stored_file(run, step.name);
    const auto read = [&](const fs::path& file) {
        return file.filename() == run_name ? finished_frames(file) : frames_so_far(file, step);
    };
    RunFrames frames;
    try {
        frames = read(path);
    } catch (const Error& error) {
        // a run that goes on may have finished the step meanwhile
        const auto now = stored_file(run, step.name);
        if (error.kind() != ErrorKind::missing || !now || *now == path) throw;
        frames = read(*now);
    }
    if (frames.list.empty()) throw Error(ErrorKind::input, path.string(), "has no frames yet");
    return frames;
}

}
