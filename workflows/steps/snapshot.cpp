// Step "snapshot": a picture of the particles of one stored frame.
#include "io/atomic_file.h"
#include "workflows/particle_colours.h"
#include "workflows/steps.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow::workflows {

namespace {

struct Snapshot {
    std::string of;
    std::optional<double> strain;
    ParticleColours colours;
    PictureSize size;

    void describe(io::Fields& f)
    {
        f("of", of, 64, "name of a step \"shear\"; default: the last one before this step");
        f("strain", strain, io::between(0, 1e4), "-",
          "draw the stored frame nearest to this strain; default: the last one");
        colours.describe(f);
        size.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        const PlannedRun& run = plan.need_run(node, of, true);
        check_within(run, node, "strain", strain);
        plan.needs.drawn_pixels = size.pixels();
    }

    void run(Context& context) const
    {
        const Run& run = context.run(of);
        const io::StoredRun stored = io::read_run(run.file);
        if (stored.frames.empty()) throw Error(ErrorKind::internal, run.file.string(), "no frames");
        const double wanted = strain.value_or(stored.frames.back().state.strain);
        const auto distance = [&](const Frame& f) { return std::abs(f.state.strain - wanted); };
        const Frame& frame = *std::min_element(
            stored.frames.begin(), stored.frames.end(),
            [&](const Frame& a, const Frame& b) { return distance(a) < distance(b); });

        context.results["strain"] = frame.state.strain;
        draw_or_note(context, [&] {
            const render::Image image = colours.draw(frame, colours.view(run, frame, size));
            io::write_file(context.folder.file(context.step_name + ".png"),
                           render::png_bytes(image));
        });
    }
};

}

StepKind snapshot_step()
{
    return step_kind<Snapshot>("snapshot",
                               "picture of the particles, coloured by one of their values");
}

}
