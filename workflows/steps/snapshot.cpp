// Step "snapshot": a picture of the particles of one stored frame.
#include "io/atomic_file.h"
#include "workflows/particle_picture.h"
#include "workflows/steps.h"

namespace sigmaflow::workflows {

namespace {

struct Snapshot {
    std::string of;
    std::optional<double> strain;
    ParticlePicture picture;

    void describe(io::Fields& f)
    {
        f("of", of, 64, "name of a step \"shear\"; default: the last one before this step");
        f("strain", strain, io::between(0, 1e4), "-",
          "draw the stored frame nearest to this strain; default: the last one");
        picture.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        const PlannedRun& run = plan.need_run(node, of, true);
        check_within(run, node, "strain", strain);
        picture.validate(node);
        plan.needs.drawn_pixels = picture.size.pixels();
    }

    void run(Context& context) const
    {
        const Run& run = context.run(of);
        const io::StoredRun stored = io::read_run(run.file);
        if (stored.frames.empty()) throw Error(ErrorKind::internal, run.file.string(), "no frames");
        const double wanted = strain.value_or(stored.frames.back().state.strain);
        const Frame& frame = stored.frames[nearest_frame(stored.frames, wanted)];
        const render::ParticleView view =
            picture.particle_view(frame, frame_title(frame, run.volume_fraction, run.control));
        context.results["strain"] = frame.state.strain;
        if (view.clip && hides_all(*view.clip, frame)) {
            context.results["outcome"] = "no picture, the clip plane hides all particles";
            return;
        }
        draw_or_note(context, [&] {
            io::write_file(context.folder.file(context.step_name + ".png"),
                           render::png_bytes(picture.draw(frame, view)));
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
