#include "workflows/uniformity_pictures.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow::workflows {

namespace {

render::Plot profile_plot(const PictureContext& pictures, Axis axis)
{
    render::Plot plot = pictures.size.plot();
    plot.title = pictures.title;
    plot.x.title = axis == gradient ? "$y$/$L_{y}$" : "$z$/$L_{z}$";
    plot.x.minimum = 0;
    plot.x.maximum = 1;
    return plot;
}

/// The profile u - y of two bands with the high one in the middle of `fraction` of the box around
/// `place`; its mean is 0.
render::Series band_series(const std::string& label, double contrast, double fraction, double place)
{
    render::Series series;
    series.label = label;
    series.line = render::Line::dashed;
    constexpr int points = 400;
    for (int k = 0; k <= points; ++k) {
        const double y = static_cast<double>(k) / points;
        // from the lower end of the high band: up through it, down through the rest
        double from = y - place + fraction / 2;
        from -= std::floor(from);
        const double height = contrast * fraction * (1 - fraction);
        const double share = from < fraction ? from / fraction : (1 - from) / (1 - fraction);
        series.x.push_back(y);
        series.y.push_back(height * (share - 0.5));
    }
    return series;
}

/// Ends of a colour scale at which its ticks stand.
double rounded_up(double value)
{
    const double step = std::pow(10, std::floor(std::log10(value)));
    for (double factor : {1., 1.5, 2., 3., 4., 6., 10.})
        if (factor * step >= value) return factor * step;
    return 10 * step;
}

}

render::Plot residual_plot(const PictureContext& pictures, const MeasuredField& velocity,
                           const UniformityTest& rate_test)
{
    render::Plot plot = profile_plot(pictures, gradient);
    plot.y.title = "$U_{x}$/($γ̇$ $L_{y}$) − $y$/$L_{y}$";
    const FieldMean mean = mean_of(velocity);
    render::Series zero;
    zero.label = "uniform shear";
    zero.x = {0, 1};
    zero.y = {0, 0};
    zero.line_width = 1.5;
    zero.colour = render::Colour{60, 60, 60};
    plot.series.push_back(std::move(zero));
    render::Series line;
    line.label = "mean over " + std::to_string(velocity.values.size()) + " frames";
    line.x = velocity.position;
    line.y = mean.mean;
    line.marker = render::Marker::circle;
    line.colour = render::Colour{200, 60, 30};
    if (!mean.standard_error.empty()) {
        render::Band band;
        band.label = "standard error";
        band.x = velocity.position;
        for (std::size_t k = 0; k < band.x.size(); ++k) {
            band.lower.push_back(mean.mean[k] - mean.standard_error[k]);
            band.upper.push_back(mean.mean[k] + mean.standard_error[k]);
        }
        band.colour = line.colour;
        plot.bands.push_back(std::move(band));
    }
    plot.series.push_back(std::move(line));
    const SteadyBands& steady = rate_test.steady;
    if (rate_test.has_steady)
        plot.series.push_back(band_series("two bands, contrast " + short_number(steady.contrast),
                                          steady.contrast, steady.fraction, steady.place));
    if (rate_test.smallest_steady)
        plot.series.push_back(band_series(
            "smallest that would be seen, contrast " + short_number(*rate_test.smallest_steady),
            *rate_test.smallest_steady, 0.5, steady.place));
    double largest = 0;
    for (const render::Series& series : plot.series)
        for (double y : series.y) largest = std::max(largest, std::abs(y));
    for (const render::Band& band : plot.bands)
        for (std::size_t k = 0; k < band.x.size(); ++k)
            largest = std::max({largest, std::abs(band.lower[k]), std::abs(band.upper[k])});
    plot.y.maximum = 1.8 * largest + 1e-6;  // room for the legend
    plot.y.minimum = -1.15 * largest - 1e-6;
    return plot;
}

render::Plot fields_plot(const PictureContext& pictures, const std::vector<MeasuredField>& fields,
                         Axis axis)
{
    static constexpr render::Marker markers[] = {render::Marker::circle, render::Marker::square,
                                                 render::Marker::triangle};
    render::Plot plot = profile_plot(pictures, axis);
    plot.y.title = "field over its mean";
    double lowest = 1, highest = 1;
    for (const MeasuredField& field : fields) {
        if (field.axis != axis || field.name == "velocity" || field.name == "shear_rate") continue;
        const FieldMean mean = mean_of(field);
        render::Series series;
        series.label = field.symbol;
        series.x = field.position;
        series.y = mean.mean;
        series.y_error = mean.standard_error;
        series.marker = markers[plot.series.size() % std::size(markers)];
        series.line_width = 1.5;
        for (std::size_t k = 0; k < series.y.size(); ++k) {
            const double error = series.y_error.empty() ? 0 : series.y_error[k];
            lowest = std::min(lowest, series.y[k] - error);
            highest = std::max(highest, series.y[k] + error);
        }
        plot.series.push_back(std::move(series));
    }
    plot.y.maximum = highest + 0.35 * (highest - lowest) + 1e-3;
    plot.y.minimum = lowest - 0.05 * (highest - lowest) - 1e-3;
    return plot;
}

std::vector<const Frame*> thinned(const std::vector<Frame>& frames)
{
    constexpr std::size_t most = 400;
    const std::size_t every = (frames.size() + most - 1) / most;
    std::vector<const Frame*> result;
    for (std::size_t i = 0; i < frames.size(); i += every) result.push_back(&frames[i]);
    return result;
}

render::Plot space_time_plot(const PictureContext& pictures,
                             const std::vector<const Frame*>& frames, const MeasuredField& field)
{
    const std::size_t columns = frames.size(), rows = field.position.size();
    const std::size_t around = std::max<std::size_t>(1, rows / 4);
    render::ColourGrid grid;
    grid.map = "blue_red";
    grid.label = field.name == "shear_rate" ? "$γ̇$($y$)/$γ̇$" : "$Z$_{f}($z$)/$Z$_{f}";
    std::vector<double> strain;
    for (const Frame* frame : frames) strain.push_back(frame->state.strain);
    grid.x.push_back(strain[0] - (strain[1] - strain[0]) / 2);
    for (std::size_t i = 1; i < columns; ++i) grid.x.push_back((strain[i - 1] + strain[i]) / 2);
    grid.x.push_back(strain.back() + (strain[columns - 1] - strain[columns - 2]) / 2);
    for (std::size_t k = 0; k <= rows; ++k)
        grid.y.push_back(static_cast<double>(k) / static_cast<double>(rows));

    // the lowest slab of the mean around the middle of row k; a rate lies on the upper faces of
    // slabs
    const std::size_t shift = (around - (field.name == "shear_rate" ? 0 : 1)) / 2;
    std::vector<double> deviations;
    for (std::size_t k = 0; k < rows; ++k)
        for (std::size_t i = 0; i < columns; ++i) {
            double sum = 0;
            for (std::size_t j = 0; j < around; ++j)
                sum += field.values[i][(k + rows - shift + j) % rows];
            grid.values.push_back(sum / static_cast<double>(around));
            deviations.push_back(std::abs(grid.values.back() - 1));
        }
    const auto place =
        deviations.begin() + static_cast<std::ptrdiff_t>(deviations.size() * 98 / 100);
    std::nth_element(deviations.begin(), place, deviations.end());
    const double range = rounded_up(std::max(*place, 1e-3));
    grid.minimum = 1 - range;
    grid.maximum = 1 + range;

    render::Plot plot = pictures.size.plot();
    plot.title = pictures.title;
    plot.x.title = "strain $γ$";
    plot.x.minimum = grid.x.front();
    plot.x.maximum = grid.x.back();
    plot.y.title = field.axis == gradient ? "$y$/$L_{y}$" : "$z$/$L_{z}$";
    plot.grid = std::move(grid);
    return plot;
}

}
