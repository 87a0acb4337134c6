// Step "nonaffine": how fast the particles move beside the affine flow, and how far that is
// correlated.
#include "engine/nonaffine_field.h"
#include "io/atomic_file.h"
#include "workflows/pictures.h"
#include "workflows/steps.h"
#include "workflows/stored_frames.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::ordered_json;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::array<const char*, 4> direction_names{"all", "flow", "gradient", "vorticity"};

/// Fields, mean squares and values over the shear rate, frame by frame.
struct Fields {
    std::vector<FieldCorrelation> correlation;
    std::vector<double> mean_square, rate, stress, power;
    std::array<std::vector<std::vector<double>>, 4> relative;  // speed, then x, y, z
};

std::string correlation_csv(const MeanFieldCorrelation& mean)
{
    std::string text =
        "# r: centre distance [a], middle of the bin; correlation <w_i.w_j>/<w^2> of the "
        "non-affine velocities, over all pairs and over pairs within 30 degrees of an axis; pairs: "
        "of all frames\nr";
    for (const std::string name : direction_names)
        text += "," + name + "," + name + "_error," + name + "_pairs";
    for (std::size_t k = 0; k < mean.distance.size(); ++k) {
        text += "\n" + io::number_text(mean.distance[k]);
        for (int d = 0; d < 4; ++d)
            text += cells(mean.value[d][k]) + "," + io::number_text(mean.pairs[d][k]);
    }
    return text + "\n";
}

std::string velocity_csv(const std::array<Histogram, 4>& histograms)
{
    std::string text =
        "# probability densities of the non-affine velocity over the shear rate times a; value: "
        "centre of the bin; the speed is never negative\n"
        "value,speed,speed_error,x,x_error,y,y_error,z,z_error";
    for (std::size_t k = 0; k < histograms[0].density.size(); ++k) {
        text += "\n" + io::number_text(histograms[0].centre(k));
        for (const Histogram& h : histograms) text += cells(h.density[k], h.standard_error[k]);
    }
    return text + "\n";
}

render::Series drawn(const Histogram& histogram, const std::string& label, render::Marker marker)
{
    render::Series series;
    series.label = label;
    series.marker = marker;
    series.line_width = 1.5;
    for (std::size_t k = 0; k < histogram.density.size(); ++k) {
        const double density = histogram.density[k], error = histogram.standard_error[k];
        if (!(density > 0)) continue;
        series.x.push_back(histogram.centre(k));
        series.y.push_back(density);
        series.y_error.push_back(error < density ? error : nan);
    }
    return series;
}

/// The size that one value in a thousand exceeds.
double thousandth_largest(const std::vector<std::vector<double>>& speeds)
{
    std::vector<double> all;
    for (const auto& frame : speeds) all.insert(all.end(), frame.begin(), frame.end());
    const auto place = all.begin() + static_cast<std::ptrdiff_t>(0.999 * (all.size() - 1));
    std::nth_element(all.begin(), place, all.end());
    return *place;
}

Json length_json(const std::optional<CorrelationLength>& length, std::size_t frames)
{
    if (!length) return {{"outcome", "not reached, the correlation stays above 1/e"}};
    if (length->shorter)
        return {{"outcome", "shorter than the distance of the nearest pairs"},
                {"shorter_than", length->length},
                {"unit", "a"}};
    Json json = {{"mean", length->length}, {"standard_error", nullptr}, {"unit", "a"}};
    if (frames > 1) json["standard_error"] = length->standard_error;
    return json;
}

Json length_json(const std::optional<IntegralLength>& length, std::size_t frames)
{
    if (!length) return {{"outcome", "no distance has pairs in every frame"}};
    Json json = {{"mean", length->length}, {"standard_error", nullptr}, {"unit", "a"}};
    if (frames > 1) json["standard_error"] = length->standard_error;
    json["to_distance"] = length->to;
    if (!length->has_zero) json["outcome"] = "the correlation has no zero within the distance";
    return json;
}

struct Nonaffine {
    FrameChoice choice;
    std::optional<double> distance;
    double bin_width = 0.25;
    int velocity_bins = 60;
    PictureSize size;
    double reach = 0;  // known when the step is validated [a]

    void describe(io::Fields& f)
    {
        choice.describe(f);
        f("distance", distance, io::above_to(0, 1e4), "a",
          "largest distance of the correlation, at most half the smallest box length; default: "
          "that, or 12 if it is more");
        f("bin_width", bin_width, io::between(0.01, 100), "a",
          "of the distance, rounded so that whole bins fit");
        f("velocity_bins", velocity_bins, io::Integers{4, 1000}, "-",
          "bins of the velocity distributions");
        size.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        const PlannedRun& run = choice.validate(node, plan);
        constexpr double longest = 12;
        reach = checked_distance(node, distance, run.narrowest_box / 2, longest);
        plan.needs.plotted_pixels = size.pixels();
    }

    int bins() const { return std::max(1, static_cast<int>(std::lround(reach / bin_width))); }

    Fields fields_of(const std::vector<Frame>& frames) const
    {
        Fields result;
        for (const Frame& frame : frames) {
            const std::vector<Vec3> field = nonaffine_field(frame.state, frame.nonaffine_velocity);
            const double square = mean_square(field), rate = frame.sample.shear_rate;
            if (!(square > 0) || rate == 0) continue;
            result.correlation.push_back(field_correlation(frame.state, field, reach, bins()));
            result.mean_square.push_back(square);
            result.rate.push_back(rate);
            result.stress.push_back(frame.sample.shear_stress);
            result.power.push_back(rate * frame.sample.shear_stress);
            for (auto& list : result.relative) list.emplace_back();
            for (const Vec3& w : field) {
                result.relative[0].back().push_back(w.norm() / std::abs(rate));
                for (int axis = 0; axis < 3; ++axis)
                    result.relative[1 + axis].back().push_back(w[axis] / std::abs(rate));
            }
        }
        return result;
    }

    void write_velocities(Context& context, const Fields& fields, const std::string& title) const
    {
        const double largest = thousandth_largest(fields.relative[0]);
        std::array<Histogram, 4> histograms;
        for (int k = 0; k < 4; ++k)
            histograms[k] = histogram(fields.relative[k], -largest, largest, velocity_bins);
        io::write_file(context.folder.file(context.step_name + "_velocity.csv"),
                       velocity_csv(histograms));
        render::Plot plot = size.plot();
        plot.title = title;
        plot.x.title = "non-affine velocity/($γ̇$ $a$)";
        plot.y.title = "probability density";
        plot.y.logarithmic = true;
        plot.series = {drawn(histograms[0], "speed", render::Marker::none),
                       drawn(histograms[1], "$x$, flow", render::Marker::circle),
                       drawn(histograms[2], "$y$, gradient", render::Marker::triangle),
                       drawn(histograms[3], "$z$, vorticity", render::Marker::square)};
        write_plot(context, context.step_name + "_velocity", plot);
    }

    void write_correlation(Context& context, const Fields& fields, const std::string& title) const
    {
        const MeanFieldCorrelation mean = mean_field_correlation(fields.correlation, reach);
        io::write_file(context.folder.file(context.step_name + ".csv"), correlation_csv(mean));
        render::Plot plot = size.plot();
        plot.title = title;
        plot.x.title = "distance $r$/$a$";
        plot.y.title = "correlation ⟨$w$ · $w$′⟩/⟨$w$^{2}⟩";
        plot.x.minimum = 0;
        constexpr std::array labels{"all pairs", "along the flow", "along the gradient",
                                    "along the vorticity"};
        constexpr std::array markers{render::Marker::none, render::Marker::circle,
                                     render::Marker::triangle, render::Marker::square};
        for (int d = 0; d < 4; ++d) {
            render::Series series;
            series.label = labels[d];
            series.marker = markers[d];
            series.line_width = d == 0 ? 3 : 1.2;
            for (std::size_t k = 0; k < mean.distance.size(); ++k) {
                if (mean.value[d][k].used == 0) continue;
                series.x.push_back(mean.distance[k]);
                series.y.push_back(mean.value[d][k].mean);
                series.y_error.push_back(mean.value[d][k].standard_error);
            }
            if (!series.x.empty()) plot.series.push_back(std::move(series));
        }
        if (plot.series.empty()) {
            context.results["correlation"] = "no pairs within the distance";
            return;
        }
        render::Series zero;
        zero.x = {0, reach};
        zero.y = {0, 0};
        zero.line = render::Line::dashed;
        zero.line_width = 1.2;
        zero.colour = render::Colour{60, 60, 60};
        plot.series.push_back(std::move(zero));
        write_plot(context, context.step_name, plot);
        for (int d = 0; d < 4; ++d) {
            const std::string name = d == 0 ? "" : std::string("_") + direction_names[d];
            context.results["correlation_length" + name] =
                length_json(correlation_length(fields.correlation, reach, d), fields.rate.size());
            context.results["integral_length" + name] =
                length_json(integral_length(fields.correlation, reach, d), fields.rate.size());
        }
    }

    void run(Context& context) const
    {
        const Run& run = context.run(choice.of);
        if (run.jammed) {
            context.results["of"] = choice.of;
            context.results["outcome"] = "no field, the suspension is jammed";
            return;
        }
        const std::vector<Frame> frames = choice.read(context).frames;
        if (frames.empty()) return;
        const Fields fields = fields_of(frames);
        if (fields.rate.empty()) {
            context.results["outcome"] = "no field, nothing moves beside the affine flow";
            return;
        }
        context.results["errors_reliable"] = estimate_mean(fields.mean_square).reliable;
        context.results["mean_square"] =
            estimate_json(product_of_means(fields.mean_square, fields.rate, -2), "a^2 rate^2");
        context.results["viscosity"] =
            estimate_json(product_of_means(fields.stress, fields.rate, -1), "eta0");
        context.results["mean_square_over_viscosity"] = estimate_json(
            product_of_means(fields.mean_square, fields.power, -1), "a^2 rate^2/eta0");
        const std::string title = title_text(run.volume_fraction, run.control, run.particles);
        write_correlation(context, fields, title);
        write_velocities(context, fields, title);
    }
};

}

StepKind nonaffine_step()
{
    return step_kind<Nonaffine>(
        "nonaffine",
        "non-affine velocities: distribution, mean square, correlation in space and its length");
}

}
