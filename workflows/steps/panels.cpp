// Step "panels": the pictures of earlier steps in one, as a figure of a paper.
#include "render/panels.h"

#include "io/atomic_file.h"
#include "workflows/pictures.h"
#include "workflows/steps.h"

#include <algorithm>

namespace sigmaflow::workflows {

namespace {

constexpr std::size_t most_pictures = 26;  // letters
constexpr int highest_picture = 65535;     // that programs commonly show [pixels]

struct Panels {
    std::vector<std::string> of;
    render::PanelStyle style;
    std::vector<std::string> steps;  // that drew them, known when this one is validated

    void describe(io::Fields& f)
    {
        f("of", of, io::Length{1, most_pictures}, 64,
          "names of earlier pictures, row by row from the top left; most steps draw one of their "
          "own name")
            .require();
        f("columns", style.columns, io::Integers{1, most_pictures}, "-", "pictures in a row");
        f("width", style.width, io::Integers{64, 16384}, "pixels",
          "of the whole picture; its height follows from those of its parts");
        f("letters", style.letters, "(a), (b) ... above the pictures");
    }

    int rows() const { return (static_cast<int>(of.size()) + style.columns - 1) / style.columns; }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        if (plan.pictures.empty())
            throw node.error("needs pictures: put steps that draw before it, as \"snapshot\"");
        std::vector<std::string_view> drawn;
        for (const PlannedPicture& picture : plan.pictures) drawn.push_back(picture.name);
        steps.clear();
        for (const io::JsonNode& name : node.member("of").elements())
            steps.push_back(plan.pictures[name.word(drawn)].step);
        const int pictures = static_cast<int>(of.size());
        if (style.columns > pictures && node.has("columns"))
            throw node.member("columns").wrong("must be <= " + std::to_string(pictures) +
                                               ", the number of pictures");
        style.columns = std::min(style.columns, pictures);
        // no row is higher than its column is wide, but for letter and gap
        const double highest = 1.1 * rows() * render::panel_width(style);
        if (highest > highest_picture)
            throw node.error("may be " + io::number_text(highest) +
                             " pixels high, must be <= " + std::to_string(highest_picture) +
                             ": take more columns or a smaller width");
        plan.uses = steps;
        plan.needs.plotted_pixels = style.width * highest;
    }

    void run(Context& context) const
    {
        std::vector<render::Panel> parts;
        std::vector<std::string> missing;
        for (const std::string& name : of) {
            const std::filesystem::path path = context.folder.path() / (name + ".png");
            if (std::filesystem::exists(path))
                parts.push_back({render::read_png(path), ""});
            else {
                missing.push_back(name);
                parts.push_back({{}, "no picture of " + name});
            }
        }
        if (!missing.empty()) context.results["without"] = missing;
        if (missing.size() == of.size()) {
            context.results["outcome"] = "no picture, none of these steps has drawn one";
        } else {
            draw_or_note(context, [&] {
                const std::string picture = render::png_bytes(render::panels(parts, style));
                io::write_file(context.folder.file(context.step_name + ".png"), picture);
            });
        }
        note_undrawn(context, steps);
    }
};

}

StepKind panels_step()
{
    return step_kind<Panels>("panels", "pictures of earlier steps in rows and columns, lettered");
}

}
