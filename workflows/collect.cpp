#include "workflows/collect.h"

#include "io/atomic_file.h"
#include "workflows/sweep_figure.h"

#include <algorithm>

namespace sigmaflow::workflows {

namespace {

/// "shear_viscosity" of "shear.viscosity.mean"; nothing that a file name cannot be.
std::string figure_name(std::string column)
{
    if (column.ends_with(".mean")) column.resize(column.size() - 5);
    std::replace(column.begin(), column.end(), '.', '_');
    std::replace(column.begin(), column.end(), '/', '_');
    return column;
}

std::string failures(const SweepFolder& sweep, const std::vector<PointStatus>& status)
{
    std::string text;
    for (std::size_t k = 0; k < status.size(); ++k)
        if (status[k].state == PointState::failed)
            text += "failed: " + sweep.points[k].name + ": " + failure_text(status[k]) + "\n";
    return text;
}

/// The name of the figure without its ending; empty: there is nothing to draw.
std::string draw(const SweepFolder& sweep, const SweepTable& table, const std::string& quantity)
{
    const std::string column = drawn_column(table, quantity);
    if (column.empty()) return "";
    const auto plot = sweep_figure(sweep, table, column);
    if (!plot) return "";
    const std::filesystem::path name = sweep.path / figure_name(column);
    io::write_file(name.string() + ".svg", render::plot_svg(*plot));
    io::write_file(name.string() + ".png", render::png_bytes(render::render_plot(*plot)));
    return name.string();
}

}

std::string collect_sweep(const SweepFolder& sweep, const std::vector<PointStatus>& status,
                          const std::string& quantity)
{
    const SweepTable runs = run_table(sweep, status);
    const bool repeated = sweep.sweep.repeats > 1;
    const SweepTable table = repeated ? over_repeats(sweep, status, runs) : runs;
    if (repeated) io::write_file(sweep.path / "runs.csv", csv_text(runs));
    io::write_file(sweep.path / "table.csv", csv_text(table));
    const std::string figure = draw(sweep, table, quantity);
    return count_text(status) + "\n" + failures(sweep, status) + "table in " +
           (sweep.path / "table.csv").string() + "\n" +
           (figure.empty() ? "no figure, there is nothing to draw yet\n"
                           : "figure in " + figure + ".png, .svg\n");
}

}
