// Step "movie": the stored frames of a run as a film and as numbered pictures.
#include "render/movie.h"
#include "io/atomic_file.h"
#include "render/offscreen.h"
#include "workflows/checkpoint.h"
#include "workflows/particle_picture.h"
#include "workflows/steps.h"

#include <vtkPolyData.h>
#include <algorithm>
#include <cmath>
#include <cstdio>

namespace sigmaflow::workflows {

namespace {

constexpr double rounding = 1e-9;

/// At most so many of the list, evenly spread, the first and the last one among them.
std::vector<Frame> spread(std::vector<Frame> frames, int most)
{
    const std::size_t count = frames.size(), wanted = static_cast<std::size_t>(most);
    if (count <= wanted) return frames;
    std::vector<Frame> chosen;
    for (std::size_t k = 0; k < wanted; ++k)
        chosen.push_back(std::move(frames[(k * (count - 1) + (wanted - 1) / 2) / (wanted - 1)]));
    return chosen;
}

std::string picture_name(const std::string& step, std::size_t number)
{
    char text[32];
    std::snprintf(text, sizeof text, "/frame_%05zu.png", number);
    return step + text;
}

struct Movie {
    std::string of;
    std::optional<double> from_strain, to_strain;
    int most_frames = 200, frames_per_second = 12;
    ParticlePicture picture;

    Movie() { picture.size = {960, 540}; }

    void describe(io::Fields& f)
    {
        f("of", of, 64, "name of a step \"shear\"; default: the last one before this step");
        f("from_strain", from_strain, io::between(0, 1e4), "-",
          "strain of the first frame; default: the beginning of the run");
        f("to_strain", to_strain, io::between(0, 1e4), "-",
          "strain of the last frame; default: the end of the run");
        f("most_frames", most_frames, io::Integers{2, 10'000}, "-",
          "if more are stored, this number of them, evenly spread");
        f("frames_per_second", frames_per_second, io::Integers{1, 60}, "1/s", "of the film");
        picture.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        const PlannedRun& run = plan.need_run(node, of, true);
        check_within(run, node, "from_strain", from_strain);
        check_within(run, node, "to_strain", to_strain);
        if (from_strain && to_strain && *to_strain < *from_strain)
            throw node.member("to_strain")
                .wrong("must be >= from_strain, " + io::number_text(*from_strain));
        picture.validate(node);
        plan.needs.drawn_pixels = picture.size.pixels();
        // the film takes less than the pictures that it is made of
        plan.needs.drawn_pictures = 2 * std::min<double>(most_frames, run.frames);
    }

    std::vector<Frame> read(const Run& run) const
    {
        std::vector<Frame> frames = io::read_run(run.file).frames;
        std::erase_if(frames, [&](const Frame& f) {
            return f.state.strain < from_strain.value_or(0) - rounding ||
                   (to_strain && f.state.strain > *to_strain + rounding);
        });
        return spread(std::move(frames), most_frames);
    }

    void run(Context& context) const
    {
        const Run& run = context.run(of);
        const std::vector<Frame> frames = read(run);
        remove_older_pictures(context);
        context.results["of"] = run.name;
        context.results["frames"] = frames.size();
        if (frames.empty()) {
            context.results["outcome"] = "no frames in this range of strain, no film";
            return;
        }
        context.results["from_strain"] = frames.front().state.strain;
        context.results["to_strain"] = frames.back().state.strain;
        context.results["seconds"] = static_cast<double>(frames.size()) / frames_per_second;
        if (frames.size() == 1) context.results["outcome"] = "one frame only";
        const auto plane = clip_plane(picture.clip);
        if (plane && std::any_of(frames.begin(), frames.end(),
                                 [&](const Frame& f) { return hides_all(*plane, f); })) {
            context.results["outcome"] = "no film, the clip plane hides all particles of a frame";
            return;
        }
        draw_or_note(context, [&] { draw(context, run, frames); });
    }

    void draw(Context& context, const Run& run, const std::vector<Frame>& frames) const
    {
        render::ParticleView view = picture.common_view(frames);
        context.results["colour_maximum"] = *view.colour_maximum;
        const std::string& name = context.step_name;
        render::MovieWriter film(context.folder.path() / (name + ".ogv.tmp"), frames_per_second);
        render::KeptWindow window;
        std::string bytes;
        for (std::size_t k = 0; k < frames.size(); ++k) {
            context.keeper.stop_if_asked();
            context.progress.update(static_cast<double>(k) / static_cast<double>(frames.size()),
                                    "frame " + std::to_string(k + 1));
            const std::string title = frame_title(frames[k], run.volume_fraction, run.control);
            view.title = picture.particle_view(frames[k], title).title;
            const render::Image image = picture.draw(frames[k], view, &window);
            film.add(image);
            bytes = render::png_bytes(image);
            io::write_file(context.folder.file(picture_name(name, k)), bytes);
        }
        io::write_file(context.folder.file(name + ".ogv"), film.finish());
        io::write_file(context.folder.file(name + ".png"), bytes);
    }

    static void remove_older_pictures(const Context& context)
    {
        std::vector<std::string> names;
        std::error_code error;
        for (const auto& entry :
             std::filesystem::directory_iterator(context.folder.path() / context.step_name, error))
            names.push_back(entry.path().filename());
        for (const std::string& name : names)
            if (name.starts_with("frame_") && name.ends_with(".png"))
                context.folder.remove(context.step_name + "/" + name);
    }
};

}

StepKind movie_step()
{
    return step_kind<Movie>("movie", "film of a run and its frames as pictures");
}

}
