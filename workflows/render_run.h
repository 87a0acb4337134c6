// workflows/render_run.h -- new pictures from what a run has stored: sigmaflow render DIR.
//
// Nothing is computed again and nothing of the run is changed: no lock is taken, no result is
// touched. The run may be complete, interrupted, failed or going on; then the frames that are
// stored so far are drawn (run.h5 of a finished step, run.journal of one on its way).
//
// Pictures go to `out`, or to DIR/render/, which belongs to no run. Several frames have one scale
// of colours and one camera, and are numbered from 0 for programs that make films.
// Errors: usage (an option that is wrong or does not fit the run), missing (no such folder), input
// (not a run, nothing stored yet, damaged files), rendering, file, no_space.
#pragma once
#include "workflows/particle_picture.h"

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

namespace sigmaflow::workflows {

struct RenderOptions {
    std::filesystem::path folder, out;
    std::string of;                    // empty: the last shearing step that has stored frames
    std::optional<double> strain;      // the frame that is nearest; default: the last one
    std::optional<std::string> range;  // "A:B" or "A:B:STEP": frames by their numbers
    bool all = false;                  // all frames
    ParticlePicture picture;
};

/// colour_by is --colour-by.
std::string option_name(std::string parameter);

/// One parameter of the picture as it comes from the command line, checked as in a workflow file;
/// Error(usage) names the option.
void set_option(ParticlePicture& picture, const std::string& name,
                const nlohmann::ordered_json& value);

/// "800x600". Errors: usage.
void set_size(ParticlePicture& picture, const std::string& text);

/// Draws and writes; `written` is told each picture when it is there.
void render_run(const RenderOptions& options,
                const std::function<void(const std::filesystem::path&)>& written);

}
