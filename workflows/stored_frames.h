// workflows/stored_frames.h -- the stored frames of a run over which a step averages.
//
// Those after the start-up; of a jammed run the last one only, because what comes before is on its
// way there. Errors come from the scatter of the frames, so one frame alone has none (null in
// summary.json).
#pragma once
#include "engine/histogram.h"
#include "engine/statistics.h"
#include "workflows/step.h"

namespace sigmaflow::workflows {

struct AveragedFrames {
    Model model;
    std::vector<Frame> frames;
};

/// The two parameters that choose them.
struct FrameChoice {
    std::string of;
    std::optional<double> from_strain;

    void describe(io::Fields& f);
    /// Errors: input.
    const PlannedRun& validate(const io::JsonNode& node, Plan& plan);
    /// Reads them, and puts into the results of the step which ones they are; none if the run ended
    /// before from_strain.
    AveragedFrames read(Context& context) const;
};

/// {"mean", "standard_error", "unit"}
nlohmann::ordered_json estimate_json(const Estimate& estimate, std::string_view unit);

/// Mean and standard error as two cells of a row, each after a comma.
std::string cells(const Estimate& estimate);
std::string cells(double mean, double standard_error);

/// Error(input) if a distance is not allowed in the box of the run. The default is half the box, at
/// most `longest` [a].
double checked_distance(const io::JsonNode& node, const std::optional<double>& distance,
                        double half_box, double longest);

}
