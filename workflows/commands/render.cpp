// sigmaflow render
#include "workflows/commands.h"
#include "workflows/render_run.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

namespace sigmaflow::workflows {

namespace {

struct PictureOption {
    std::string name, text;  // as in a workflow file; as given
    bool is_number = false;
    const CLI::Option* option = nullptr;
};

struct RenderArguments {
    RenderOptions options;
    std::string folder, out, range, size;
    std::vector<PictureOption> picture;
};

/// The parameters of the step `snapshot` as options.
void declare_picture(CLI::App& app, RenderArguments& given)
{
    io::Fields fields;
    given.options.picture.describe(fields);
    for (const io::Field& field : fields.list())
        if (field.name != "width" && field.name != "height")
            given.picture.push_back({field.name, "", field.kind == io::FieldKind::number, nullptr});
    for (PictureOption& one : given.picture) {
        const auto field = std::find_if(fields.list().begin(), fields.list().end(),
                                        [&](const io::Field& f) { return f.name == one.name; });
        std::string help = field->help;
        if (one.name != "clip") help += " (" + field->allowed() + ")";
        one.option = app.add_option("--" + option_name(one.name), one.text, help);
    }
}

nlohmann::ordered_json value_of(const PictureOption& given)
{
    if (!given.is_number) return given.text;
    double number = 0;
    if (!CLI::detail::lexical_cast(given.text, number))
        throw Error(ErrorKind::usage, "--" + option_name(given.name),
                    "must be a number, got \"" + given.text + "\"");
    return number;
}

Work declare(CLI::App& app)
{
    const auto given = std::make_shared<RenderArguments>();
    RenderOptions& options = given->options;
    app.add_option("DIR", given->folder, "the folder of the run")->required();
    app.add_option("--of", options.of,
                   "the step whose frames are drawn, default: the last \"shear\"");
    app.add_option("--strain", options.strain,
                   "draw the stored frame nearest to this strain, default: the last one");
    const CLI::Option* range =
        app.add_option("--frames", given->range,
                       "A:B or A:B:STEP: several frames by their numbers from 0, in one scale of "
                       "colours, as 00000.png, 00001.png, ...");
    app.add_flag("--all", options.all, "all frames, likewise");
    declare_picture(app, *given);
    const CLI::Option* size =
        app.add_option("--size", given->size, "WIDTHxHEIGHT in pixels, default 1920x1080");
    const CLI::Option* out =
        app.add_option("--out", given->out,
                       "FILE.png, or a folder (a new or empty one for several frames); default: a "
                       "name in DIR/render");
    return [given, range, size, out] {
        RenderOptions& chosen = given->options;
        if (out->count()) need_text("--out", given->out, "must name a file or a folder");
        chosen.folder = given->folder;
        chosen.out = given->out;
        if (range->count()) chosen.range = given->range;
        for (const PictureOption& one : given->picture)
            if (one.option->count()) set_option(chosen.picture, one.name, value_of(one));
        if (size->count()) set_size(chosen.picture, given->size);
        render_run(chosen,
                   [](const std::filesystem::path& path) { print_result(path.string() + "\n"); });
    };
}

}

Command render_command()
{
    return {
        "render", "new pictures of what a run has stored, without running it again",
        R"(  sigmaflow render out/quickstart                     the last frame, in out/quickstart/render
  sigmaflow render out/quickstart --clip z=5          what lies behind z = 5
  sigmaflow render out/quickstart --view front --strain 1 --out front.png
                                                      one frame in the shear plane
  sigmaflow render out/quickstart --all --out frames  for ffmpeg -i frames/%05d.png film.mp4)",
        declare};
}

}
