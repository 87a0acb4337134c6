#include "workflows/render_run.h"

#include "io/atomic_file.h"
#include "render/offscreen.h"
#include "workflows/past_run.h"
#include "workflows/run_folder.h"
#include "workflows/run_frames.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace sigmaflow::workflows {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr const char* picture_folder = "render";  // in that of the run
constexpr double rounding = 1e-9;

[[noreturn]] void refuse(const std::string& option, const std::string& problem)
{
    throw Error(ErrorKind::usage, option, problem);
}

/// Whole numbers between colons; an empty one is not given.
std::vector<std::optional<std::size_t>> numbers_of(const std::string& text)
{
    std::vector<std::optional<std::size_t>> numbers;
    const auto wrong = [&] {
        refuse("--frames",
               "must be A:B or A:B:STEP with the numbers of frames from 0, as 0:20 or 10::2, got "
               "\"" +
                   text + "\"");
    };
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(':', begin), text.size());
        std::size_t number = 0;
        const char *first = text.data() + begin, *last = text.data() + end;
        const auto result = std::from_chars(first, last, number);
        if (first == last)
            numbers.emplace_back();
        else if (result.ec == std::errc() && result.ptr == last)
            numbers.emplace_back(number);
        else
            wrong();
        begin = end + 1;
    }
    if (numbers.size() < 2 || numbers.size() > 3 || (numbers.size() == 3 && numbers[2] == 0u))
        wrong();
    numbers.resize(3);
    return numbers;
}

std::vector<std::size_t> in_range(const std::string& text, std::size_t count)
{
    const auto numbers = numbers_of(text);
    const std::size_t first = numbers[0].value_or(0), last = numbers[1].value_or(count - 1);
    if (first > last || last >= count)
        refuse("--frames", "must lie within 0:" + std::to_string(count - 1) +
                               ", the numbers of the stored frames, got \"" + text + "\"");
    std::vector<std::size_t> chosen;
    for (std::size_t k = first; k <= last; k += numbers[2].value_or(1)) chosen.push_back(k);
    return chosen;
}

std::vector<std::size_t> chosen_frames(const RenderOptions& options,
                                       const std::vector<Frame>& frames)
{
    if (options.range) return in_range(*options.range, frames.size());
    if (options.all) return in_range("0:", frames.size());
    const double first = frames.front().state.strain, last = frames.back().state.strain;
    const double wanted = options.strain.value_or(last);
    if (!(wanted >= first - rounding && wanted <= last + rounding))
        refuse("--strain", "must be between " + short_number(first) + " and " + short_number(last) +
                               ", the strains of the stored frames, got " + short_number(wanted));
    return {nearest_frame(frames, wanted)};
}

/// The last frame of several decides: a plane that hides all of one is an error before drawing.
void check_clip(const std::string& clip, const std::vector<Frame>& frames,
                const std::vector<std::size_t>& chosen)
{
    const auto plane = clip_plane(clip);
    if (!plane) return;
    for (const std::size_t k : chosen) {
        if (!hides_all(*plane, frames[k])) continue;
        const Vec3& box = frames[k].state.box.length;
        refuse("--clip", "hides all particles at strain " + short_number(frames[k].state.strain) +
                             ", the box has " + "xyz"[plane->axis] + " from 0 to " +
                             short_number(box[plane->axis]) + ", got \"" + clip + "\"");
    }
}

/// Says what is not the default.
std::string file_stem(const std::string& step, const ParticlePicture& picture)
{
    const ParticlePicture usual;
    std::string stem = step;
    if (picture.colour_by != usual.colour_by) stem += "_" + picture.colour_by;
    if (picture.viewed_from != usual.viewed_from) stem += "_" + picture.viewed_from;
    return stem;
}

/// Inside the folder of the run, only the folder for pictures is free.
void keep_off_results(const PastRun& run, const fs::path& out)
{
    std::error_code error;
    const fs::path way = fs::weakly_canonical(fs::absolute(out))
                             .lexically_relative(fs::canonical(run.folder, error));
    if (!is_inside(way)) return;
    if (*way.begin() != picture_folder)
        refuse("--out", out.string() + " lies in the folder of the run, where only " +
                            (run.folder / picture_folder).string() + "/ is free for pictures");
    for (const PastStep& step : run.steps)
        if (step.name == picture_folder)
            refuse("--out", "must be outside of the folder of the run, which has a step \"" +
                                std::string(picture_folder) + "\"");
}

fs::path single_path(const RenderOptions& options, const PastRun& run, const std::string& stem,
                     double strain)
{
    const std::string name = stem + "_strain_" + short_number(strain) + ".png";
    std::error_code error;
    if (options.out.empty()) return run.folder / picture_folder / name;
    if (!options.out.has_filename() || fs::is_directory(options.out, error))
        return options.out / name;
    if (options.out.extension() != ".png")
        refuse("--out", "must be a folder or a file that ends with .png, got \"" +
                            options.out.string() + "\"");
    return options.out;
}

/// Films are made of all pictures in a folder, so those of another one may not lie there.
fs::path folder_for_film(const RenderOptions& options, const PastRun& run, const std::string& stem)
{
    const fs::path folder = options.out.empty() ? run.folder / picture_folder / stem : options.out;
    std::error_code error;
    if (folder.extension() == ".png")
        refuse("--out",
               "must be a folder if several frames are drawn, got \"" + folder.string() + "\"");
    if (fs::is_directory(folder, error) && !fs::is_empty(folder, error))
        throw Error(ErrorKind::file, folder.string(),
                    "is not empty: empty it, or name another folder by --out");
    return folder;
}

void make_folder(const fs::path& folder)
{
    if (folder.empty()) return;
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw io::write_error(folder, error.value());
}

void check(const RenderOptions& options)
{
    const int choices =
        int{options.strain.has_value()} + int{options.range.has_value()} + int{options.all};
    if (choices > 1) refuse("", "only one of --strain, --frames and --all can be given");
}

}

std::string option_name(std::string parameter)
{
    std::replace(parameter.begin(), parameter.end(), '_', '-');
    return parameter;
}

void set_option(ParticlePicture& picture, const std::string& name, const Json& value)
{
    io::Fields fields;
    picture.describe(fields);
    try {
        const io::JsonDocument document =
            io::JsonDocument::parse(Json{{name, value}}.dump(), "option");
        io::read_fields(document.root(), fields.list());
        picture.validate(document.root());
    } catch (const Error& error) {
        refuse("--" + option_name(name), error.problem());
    }
}

void set_size(ParticlePicture& picture, const std::string& text)
{
    const auto wrong = [&] {
        refuse("--size",
               "must be WIDTHxHEIGHT in pixels, each from 64 to 16384, as 1280x720, got "
               "\"" +
                   text + "\"");
    };
    const std::size_t cross = text.find('x');
    const auto number = [&](std::size_t begin, std::size_t end) {
        int value = 0;
        const char *first = text.data() + begin, *last = text.data() + end;
        const auto result = std::from_chars(first, last, value);
        if (result.ec != std::errc() || result.ptr != last || value < 64 || value > 16384) wrong();
        return value;
    };
    if (cross == std::string::npos) wrong();
    picture.size.width = number(0, cross);
    picture.size.height = number(cross + 1, text.size());
}

void render_run(const RenderOptions& options,
                const std::function<void(const std::filesystem::path&)>& written)
{
    check(options);
    const PastRun run = read_past_run(options.folder);
    const PastStep& step = step_with_frames(run, options.of);
    const RunFrames frames = read_frames(run, step);
    const std::vector<std::size_t> chosen = chosen_frames(options, frames.list);
    check_clip(options.picture.clip, frames.list, chosen);

    const bool film = options.range || options.all;
    const std::string stem = file_stem(step.name, options.picture);
    const fs::path path =
        film ? folder_for_film(options, run, stem)
             : single_path(options, run, stem, frames.list[chosen.front()].state.strain);
    keep_off_results(run, path);
    std::vector<Frame> drawn;
    for (const std::size_t k : chosen) drawn.push_back(frames.list[k]);
    render::ParticleView view =
        film ? options.picture.common_view(drawn) : options.picture.particle_view(drawn[0], "");
    render::KeptWindow window;
    for (std::size_t k = 0; k < drawn.size(); ++k) {
        const Frame& frame = drawn[k];
        view.title =
            options.picture
                .particle_view(frame, frame_title(frame, frame.volume_fraction, frames.control))
                .title;
        char name[32];
        std::snprintf(name, sizeof name, "%05zu.png", k);
        const fs::path file = film ? path / name : path;
        const std::string bytes = render::png_bytes(options.picture.draw(frame, view, &window));
        make_folder(file.parent_path());
        io::write_file(file, bytes);
        written(file);
    }
}

}
