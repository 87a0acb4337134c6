#include "workflows/pictures.h"

#include "io/atomic_file.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

namespace sigmaflow::workflows {

namespace {

void note(Context& context, const std::string& problem)
{
    context.problems.push_back({context.step_name, context.step_name + ": " + problem});
    context.progress.note(context.problems.back().text);
}

}

void draw_or_note(Context& context, const std::function<void()>& draw)
{
    try {
        draw();
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::rendering) throw;
        note(context, error.what());
    }
}

void note_undrawn(Context& context, const std::vector<std::string>& steps)
{
    std::string undrawn;
    for (const Problem& problem : context.problems)
        if (std::find(steps.begin(), steps.end(), problem.step) != steps.end())
            undrawn += (undrawn.empty() ? "" : ", ") + problem.step;
    if (!undrawn.empty()) note(context, "lacks what could not be drawn: " + undrawn);
}

void write_plot(Context& context, const std::string& name, const render::Plot& plot)
{
    io::write_file(context.folder.file(name + ".svg"), render::plot_svg(plot));
    draw_or_note(context, [&] {
        const std::string picture = render::png_bytes(render::render_plot(plot));
        io::write_file(context.folder.file(name + ".png"), picture);
    });
}

void PictureSize::describe(io::Fields& f)
{
    f("width", width, io::Integers{64, 16384}, "pixels", "width of the picture");
    f("height", height, io::Integers{64, 16384}, "pixels", "height of the picture");
}

render::Plot PictureSize::plot() const
{
    render::Plot plot;
    plot.width = width;
    plot.height = height;
    return plot;
}

std::string short_number(double value)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value);
    return text;
}

std::string title_text(double volume_fraction, const Control& control, int particles)
{
    std::string imposed;
    if (const auto* stress = std::get_if<ImposedStress>(&control))
        imposed = "$σ$/$σ$_{0} = " + short_number(stress->value);
    else
        imposed = "$γ̇$/$γ̇$_{0} = " + short_number(std::get<ImposedRate>(control).value);
    return "$ϕ$ = " + short_number(volume_fraction) + ", " + imposed +
           ", $n$ = " + std::to_string(particles);
}

std::string axis_text(const SampleField& field)
{
    static constexpr std::array<std::pair<std::string_view, const char*>, 6> texts{{
        {"strain", "strain $γ$"},
        {"time", "time $t$ $γ̇$_{0}"},
        {"shear_rate", "shear rate $γ̇$/$γ̇$_{0}"},
        {"shear_stress", "shear stress $σ$/$σ$_{0}"},
        {"viscosity", "viscosity $η$/$η$_{0}"},
        {"contact_number", "contact number $Z$"},
    }};
    for (const auto& [name, text] : texts)
        if (name == field.name) return text;
    std::string result(field.name);
    for (char& c : result)
        if (c == '_') c = ' ';
    if (field.unit == "sigma0") return result + " / $σ$_{0}";
    if (field.unit.empty() || field.unit == "-") return result;
    return result + " [" + std::string(field.unit) + "]";
}

}
