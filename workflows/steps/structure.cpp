// Step "structure": where the neighbours of a particle are.
#include "engine/pair_correlation.h"
#include "io/atomic_file.h"
#include "render/polar_map.h"
#include "workflows/pictures.h"
#include "workflows/steps.h"
#include "workflows/stored_frames.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<const char*, 3> species_pairs{"small_small", "small_large", "large_large"};
constexpr std::array<const char*, 3> species_labels{"small, small", "small, large", "large, large"};

std::string distances_csv(const MeanPairCorrelation& g, const CorrelationGrid& grid)
{
    std::string text =
        "# r: centre distance [a], middle of the bin; g = 1 for an ideal gas\n"
        "r,all,all_error";
    for (std::size_t s = 0; s < g.by_species.size(); ++s)
        text += std::string(",") + species_pairs[s] + "," + species_pairs[s] + "_error";
    for (int k = 0; k < grid.bins; ++k) {
        text += "\n" + io::number_text(grid.distance(k)) + cells(g.all[k]);
        for (const auto& pair : g.by_species) text += cells(pair[k]);
    }
    return text + "\n";
}

std::string angles_csv(const MeanPairCorrelation& g, const CorrelationGrid& grid)
{
    std::string text =
        "# angle of near neighbours from the flow towards the gradient [degrees]; "
        "density: relative to isotropic ones\nangle,density,standard_error";
    for (std::size_t k = 0; k < g.near.size(); ++k)
        text += "\n" + io::number_text(grid.angle(static_cast<int>(k))) + cells(g.near[k]);
    return text + "\n";
}

std::string map_csv(const MeanPairCorrelation& g, const CorrelationGrid& grid)
{
    std::string text =
        "# g(r, angle) in the shear plane; r [a], angle from the flow towards the "
        "gradient [degrees], the same at angle + 180\nr,angle,g,standard_error";
    for (int ring = 0; ring < grid.map_bins; ++ring)
        for (int angle = 0; angle < grid.angles; ++angle)
            text += "\n" + io::number_text(grid.map_distance(ring)) + "," +
                    io::number_text(grid.angle(angle)) + cells(g.map[ring * grid.angles + angle]);
    return text + "\n";
}

render::Series curve(const std::vector<Estimate>& g, const CorrelationGrid& grid,
                     const std::string& label)
{
    render::Series series;
    series.label = label;
    for (int k = 0; k < grid.bins; ++k) {
        series.x.push_back(grid.distance(k));
        series.y.push_back(g[k].mean);
    }
    return series;
}

Json peak_json(const Peak& peak, double bin_width)
{
    return {{"distance", peak.distance},
            {"bin_width", bin_width},
            {"height", estimate_json(peak.height, "-")}};
}

struct Structure {
    FrameChoice choice;
    std::optional<double> distance;
    double bin_width = 0.05, map_bin_width = 0.1, slab = 0.3, near_xi = 0.1;
    int angles = 48;
    PictureSize size;
    CorrelationGrid grid;  // known when the step is validated

    void describe(io::Fields& f)
    {
        choice.describe(f);
        f("distance", distance, io::above_to(0, 1e4), "a",
          "largest distance, at most half the smallest box length; default: that, or 8 if it is "
          "more");
        f("bin_width", bin_width, io::between(0.001, 10), "a",
          "of the distance in g(r), rounded so that whole bins fit");
        f("map_bin_width", map_bin_width, io::between(0.01, 10), "a",
          "of the distance in g(r, angle), rounded so that whole bins fit");
        f("angles", angles, io::Integers{4, 720}, "-", "bins of the angle over 180 degrees");
        f("slab", slab, io::above_to(0, 1), "-",
          "pairs count in the shear plane if the vorticity component of their direction is "
          "smaller");
        f("near_xi", near_xi, io::between(0, 2), "-",
          "pairs with a smaller reduced gap are near neighbours");
        size.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        const PlannedRun& run = choice.validate(node, plan);
        if (run.particles < 2) throw node.error("needs at least two particles");
        constexpr double longest = 8;
        const double half = run.narrowest_box / 2, largest = run.largest_radius;
        if (largest * (2 + near_xi) > half)
            throw node.error("needs a larger box, half its smallest length is " +
                             io::number_text(half) + ", near neighbours are up to " +
                             io::number_text(largest * (2 + near_xi)) + " apart");
        grid.largest_distance = checked_distance(node, distance, half, longest);
        const auto count = [&](double width) {
            return std::max(1, static_cast<int>(std::lround(grid.largest_distance / width)));
        };
        grid.bins = count(bin_width);
        grid.map_bins = count(map_bin_width);
        grid.angles = angles;
        grid.slab = slab;
        grid.near_xi = near_xi;
        plan.needs.plotted_pixels = size.pixels();
    }

    void draw_distances(Context& context, const MeanPairCorrelation& g,
                        const std::string& title) const
    {
        render::Plot plot = size.plot();
        plot.title = title;
        plot.x.title = "distance $r$/$a$";
        plot.y.title = "pair correlation $g$($r$)";
        plot.x.minimum = 0;
        plot.y.minimum = 0;
        for (std::size_t s = 0; s < g.by_species.size(); ++s) {
            plot.series.push_back(curve(g.by_species[s], grid, species_labels[s]));
            plot.series.back().line_width = 1.5;
        }
        plot.series.push_back(curve(g.all, grid, "all"));
        plot.series.back().line_width = 3.5;
        plot.series.back().colour = render::Colour{40, 40, 46};
        write_plot(context, context.step_name, plot);
    }

    void draw_angles(Context& context, const MeanPairCorrelation& g, const std::string& title) const
    {
        if (g.near.empty()) {
            context.results["near"] = "no near neighbours, no picture of their angles";
            return;
        }
        render::Plot plot = size.plot();
        plot.title = title + ", near neighbours in the shear plane";
        plot.x.title = "angle from the flow [degrees]";
        plot.y.title = "density, 1: isotropic";
        plot.x.minimum = 0;
        plot.x.maximum = 180;
        plot.y.minimum = 0;
        plot.spans = {{90, 180, "compression"}};
        render::Series series;
        series.marker = render::Marker::circle;
        series.line_width = 1.5;
        for (std::size_t k = 0; k < g.near.size(); ++k) {
            series.x.push_back(grid.angle(static_cast<int>(k)));
            series.y.push_back(g.near[k].mean);
            series.y_error.push_back(g.near[k].standard_error);
        }
        plot.series.push_back(std::move(series));
        render::Series one;
        one.x = {0, 180};
        one.y = {1, 1};
        one.line = render::Line::dashed;
        one.line_width = 1.5;
        one.colour = render::Colour{60, 60, 60};
        plot.series.push_back(std::move(one));
        write_plot(context, context.step_name + "_angles", plot);
    }

    void draw_map(Context& context, const MeanPairCorrelation& g, const std::string& title) const
    {
        render::PolarMap map;
        map.height = size.height;
        map.title = title;
        map.x_title = "flow $x$/$a$";
        map.y_title = "gradient $y$/$a$";
        map.label = "$g$($r$, $θ$)";
        map.largest_distance = grid.largest_distance;
        map.rings = grid.map_bins;
        map.sectors = grid.angles;
        for (const Estimate& value : g.map) map.values.push_back(value.mean);
        draw_or_note(context, [&] {
            io::write_file(context.folder.file(context.step_name + "_map.png"),
                           render::png_bytes(render::render_polar_map(map)));
        });
    }

    void run(Context& context) const
    {
        const Run& run = context.run(choice.of);
        std::vector<PairCorrelation> frames;
        for (const Frame& frame : choice.read(context).frames)
            frames.push_back(pair_correlation(frame.state, grid));
        if (frames.empty()) return;
        const MeanPairCorrelation g = mean_pair_correlation(frames);
        const auto write = [&](const char* suffix, const std::string& text) {
            io::write_file(context.folder.file(context.step_name + suffix), text);
        };
        write(".csv", distances_csv(g, grid));
        write("_angles.csv", angles_csv(g, grid));
        write("_map.csv", map_csv(g, grid));

        context.results["errors_reliable"] = g.near_neighbours.reliable;
        context.results["largest_distance"] = grid.largest_distance;
        context.results["near_neighbours"] = estimate_json(g.near_neighbours, "-");
        context.results["quadrant_anisotropy"] = estimate_json(g.quadrant_anisotropy, "-");
        const double width = grid.largest_distance / grid.bins;
        context.results["peak"]["all"] = peak_json(highest_peak(g.all, grid), width);
        for (std::size_t s = 0; s < g.by_species.size(); ++s)
            context.results["peak"][species_pairs[s]] =
                peak_json(highest_peak(g.by_species[s], grid), width);
        const std::string title = title_text(run.volume_fraction, run.control, run.particles);
        draw_distances(context, g, title);
        draw_angles(context, g, title);
        draw_map(context, g, title);
    }
};

}

StepKind structure_step()
{
    return step_kind<Structure>(
        "structure", "pair correlation g(r), g(r, angle) in the shear plane, near neighbours");
}

}
