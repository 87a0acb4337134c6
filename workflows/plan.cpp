// What the steps of a workflow ask of each other (workflows/step.h).
#include "workflows/step.h"

#include <algorithm>

namespace sigmaflow::workflows {

void Plan::need_state(const io::JsonNode& step) const
{
    if (!has_state) throw step.error("needs particles: put a step \"pack\" before it");
}

void Plan::need_suspension(const io::JsonNode& step) const
{
    if (!has_suspension)
        throw step.error("needs a \"suspension\" in the workflow: only stored runs do without");
}

PlannedRun Plan::shears(const Control& control, double strain, double frames) const
{
    return {.name = step_name,
            .control = control,
            .particles = particles,
            .volume_fraction = volume_fraction,
            .narrowest_box = narrowest_box,
            .largest_radius = largest_radius,
            .strain = strain,
            .frames = frames};
}

const PlannedRun& Plan::need_run(const io::JsonNode& step, std::string& of, bool with_frames)
{
    const auto found = [&](const PlannedRun& run) -> const PlannedRun& {
        needs.particles = run.particles;
        uses.push_back(run.name);
        if (with_frames) needs.frames_read = run.frames;
        return run;
    };
    const auto usable = [&](const PlannedRun& run) { return run.frames > 0 || !with_frames; };
    const std::string wanted = with_frames ? "\"shear\"" : "\"shear\" or \"equilibrate\"";
    if (of.empty()) {
        const auto last = std::find_if(runs.rbegin(), runs.rend(), usable);
        if (last == runs.rend())
            throw step.error("needs a run: put a step " + wanted + " before it");
        of = last->name;
        return found(*last);
    }
    std::vector<std::string_view> names;
    for (const PlannedRun& run : runs)
        if (usable(run)) names.push_back(run.name);
    if (names.empty()) throw step.error("needs a run: put a step " + wanted + " before it");
    const std::size_t index = step.member("of").word(names);
    return found(*std::find_if(runs.begin(), runs.end(),
                               [&](const PlannedRun& run) { return run.name == names[index]; }));
}

void check_within(const PlannedRun& run, const io::JsonNode& step, const char* key,
                  const std::optional<double>& strain)
{
    if (strain && *strain > run.strain)
        throw step.member(key).wrong("must be <= " + io::number_text(run.strain) +
                                     ", the strain of " + io::in_quotes(run.name));
}

const Run& Context::run(const std::string& name) const
{
    const auto it =
        std::find_if(runs.begin(), runs.end(), [&](const Run& run) { return run.name == name; });
    if (it == runs.end()) throw Error(ErrorKind::internal, name, "run does not exist");
    return *it;
}

void Plan::assume_results()
{
    constexpr double plenty = 1e6;
    has_state = true;
    if (particles == 0) {
        particles = suspension.packing.particles;
        volume_fraction = suspension.packing.volume_fraction;
    }
    if (narrowest_box == 0) narrowest_box = plenty;
    if (largest_radius == 0) largest_radius = 1;
    runs.push_back(shears(ImposedStress{1}, plenty, plenty));
    pictures.push_back({step_name, step_name});
    responses.push_back(step_name);
}

}
