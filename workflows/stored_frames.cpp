#include "workflows/stored_frames.h"

#include <algorithm>

namespace sigmaflow::workflows {

namespace {

constexpr double rounding = 1e-9;

}

void FrameChoice::describe(io::Fields& f)
{
    f("of", of, 64, "name of a step \"shear\"; default: the last one before this step");
    f("from_strain", from_strain, io::between(0, 1e4), "-",
      "strain of the first frame; default: where the start-up ends. Of a jammed run the last frame "
      "counts alone");
}

const PlannedRun& FrameChoice::validate(const io::JsonNode& node, Plan& plan)
{
    const PlannedRun& run = plan.need_run(node, of, true);
    check_within(run, node, "from_strain", from_strain);
    return run;
}

AveragedFrames FrameChoice::read(Context& context) const
{
    const Run& run = context.run(of);
    io::StoredRun stored = io::read_run(run.file);
    std::vector<Frame>& frames = stored.frames;
    if (frames.empty()) throw Error(ErrorKind::internal, run.file.string(), "no frames");
    const double from =
        run.jammed ? frames.back().state.strain : from_strain.value_or(run.start_up.value_or(0));
    std::erase_if(frames, [&](const Frame& f) { return f.state.strain < from - rounding; });

    context.results["of"] = run.name;
    context.results["frames"] = frames.size();
    if (frames.empty()) {
        context.results["outcome"] = "no frames, the run ended before from_strain";
        return {stored.model, {}};
    }
    if (run.jammed)
        context.results["outcome"] = "jammed, the last frame only, no errors";
    else if (frames.size() < 2)
        context.results["outcome"] = "one frame only, no errors";
    context.results["averages_from_strain"] = frames.front().state.strain;
    return {stored.model, std::move(frames)};
}

nlohmann::ordered_json estimate_json(const Estimate& estimate, std::string_view unit)
{
    nlohmann::ordered_json json = {
        {"mean", estimate.mean}, {"standard_error", nullptr}, {"unit", unit}};
    if (estimate.used > 1) json["standard_error"] = estimate.standard_error;
    return json;
}

std::string cells(double mean, double standard_error)
{
    return "," + io::number_text(mean) + "," + io::number_text(standard_error);
}

std::string cells(const Estimate& estimate)
{
    if (estimate.used == 0) return ",,";
    if (estimate.used == 1) return "," + io::number_text(estimate.mean) + ",";
    return cells(estimate.mean, estimate.standard_error);
}

double checked_distance(const io::JsonNode& node, const std::optional<double>& distance,
                        double half_box, double longest)
{
    if (distance && *distance > half_box)
        throw node.member("distance")
            .wrong("must be <= " + io::number_text(half_box) + ", half the smallest box length");
    return distance.value_or(std::min(half_box, longest));
}

}
