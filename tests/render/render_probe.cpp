// tests/render/render_probe.cpp -- draws one picture and says how that went: the exit code is that
// of the error, its text goes to the standard output, and the error output stays empty.
#include "engine/error.h"
#include "render/line_plot.h"
#include "render/particles.h"

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <cstdio>
#include <string>

using namespace sigmaflow;

namespace {

render::Plot small_plot()
{
    render::Plot plot;
    plot.width = plot.height = 200;
    plot.series.push_back(
        {.label = "line", .x = {0, 1}, .y = {0, 1}, .x_error = {}, .y_error = {}, .colour = {}});
    return plot;
}

int draw(const std::string& what)
{
    if (what == "why") std::printf("%s", render::why_unavailable().c_str());
    if (what == "plot") return render::render_plot(small_plot()).width == 200 ? 0 : 1;
    if (what == "svg") std::printf("%s", render::plot_svg(small_plot()).c_str());
    if (what == "particles") {
        render::ParticleView view;
        view.width = view.height = 100;
        view.box_length = {1, 1, 1};
        render::render_particles(vtkSmartPointer<vtkPolyData>::New(), view);
    }
    return 0;
}

}

int main(int count, char** arguments)
{
    try {
        return draw(count > 1 ? arguments[1] : "");
    } catch (const Error& error) {
        std::printf("%s", error.what());
        return static_cast<int>(error.kind());
    }
}
