// Step "snapshot": a picture of the particles of one stored frame.
#include "io/atomic_file.h"
#include "io/particles_vtp.h"
#include "render/particles.h"
#include "workflows/pictures.h"
#include "workflows/steps.h"

#include <vtkPolyData.h>
#include <algorithm>
#include <cmath>

namespace sigmaflow::workflows {

namespace {

struct Snapshot {
    std::string of;
    std::optional<double> strain;
    std::string colour_by = "nonaffine_speed", colour_map = "inferno";
    std::optional<double> colour_maximum;
    PictureSize size;

    void describe(io::Fields& f)
    {
        f("of", of, 64, "name of a step \"shear\"; default: the last one before this step");
        f("strain", strain, io::between(0, 1e4), "-",
          "draw the stored frame nearest to this strain; default: the last one");
        f("colour_by", colour_by,
          std::vector<std::string_view>{"nonaffine_speed", "contact_number", "radius", "species",
                                        "normal_force"},
          "what the colours show; nonaffine_speed is |U - U_inf|/(shear rate a); normal_force "
          "[F*]: the chains of contacts above the mean force, between small spheres");
        f("colour_map", colour_map, std::vector<std::string_view>{"inferno", "viridis", "paper"},
          "paper: dark grey to yellow");
        f("colour_maximum", colour_maximum, io::above(0), "-",
          "value of the last colour; default: from the data");
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

        render::ParticleView view;
        view.width = size.width;
        view.height = size.height;
        const Vec3& box = frame.state.box.length;
        view.box_length = {box.x(), box.y(), box.z()};
        view.colour_by = colour_by;
        view.colour_map = colour_map;
        view.colour_maximum = colour_maximum;
        view.title = title_text(run.volume_fraction, run.control, frame.state.size()) +
                     ", $γ$ = " + short_number(frame.state.strain);
        context.results["strain"] = frame.state.strain;
        draw_or_note(context, [&] {
            const auto particles = io::particles_polydata(frame);
            const render::Image image =
                colour_by == "normal_force"
                    ? render::render_chains(particles, io::contacts_polydata(frame), view)
                    : render::render_particles(particles, view);
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
