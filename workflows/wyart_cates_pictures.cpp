#include "workflows/wyart_cates_pictures.h"

#include "engine/wyart_cates_uncertainty.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace sigmaflow::workflows {

namespace {

constexpr render::Colour grey{120, 120, 130}, red{200, 60, 30}, dark{40, 40, 46};

struct Extent {
    double low = std::numeric_limits<double>::infinity(), high = 0;

    void add(double value)
    {
        low = std::min(low, value);
        high = std::max(high, value);
    }
};

/// At equal ratios.
std::vector<double> spaced(const Extent& extent, int intervals)
{
    std::vector<double> result;
    for (int k = 0; k <= intervals; ++k)
        result.push_back(extent.low * std::pow(extent.high / extent.low, double(k) / intervals));
    return result;
}

void for_each_point(const Curves& curves,
                    const std::function<void(double volume_fraction, const Measured&)>& visit)
{
    for (const auto& [volume_fraction, curve] : curves)
        for (const auto& [stress, m] : curve.by_stress) visit(volume_fraction, m);
}

/// Of all imposed stresses, with room for the curves beyond.
Extent drawn_stresses(const Curves& curves)
{
    Extent extent;
    for_each_point(curves, [&](double, const Measured& m) { extent.add(m.stress.mean); });
    return {extent.low / 2, extent.high * 2};
}

/// For each x the range of stresses at the ends of which `inside` holds.
render::Band region(const std::string& label, render::Colour colour, const std::vector<double>& x,
                    const std::vector<double>& stresses,
                    const std::function<bool(double x, double stress)>& inside)
{
    render::Band band{.label = label, .x = {}, .lower = {}, .upper = {}, .colour = colour};
    for (double at : x) {
        const auto here = [&](double stress) { return inside(at, stress); };
        const auto first = std::find_if(stresses.begin(), stresses.end(), here);
        if (first == stresses.end()) continue;
        band.x.push_back(at);
        band.lower.push_back(*first);
        band.upper.push_back(*std::find_if(stresses.rbegin(), stresses.rend(), here));
    }
    return band;
}

render::Series points_series(const std::string& label, render::Marker marker, render::Colour colour)
{
    render::Series series;
    series.label = label;
    series.line = render::Line::none;
    series.marker = marker;
    series.colour = colour;
    return series;
}

render::Series line_series(const std::string& label, render::Line line, render::Colour colour)
{
    render::Series series;
    series.label = label;
    series.line = line;
    series.colour = colour;
    return series;
}

/// Solid where the rate rises with the stress, dashed where it falls.
void add_model_curve(render::Plot& plot, const WyartCates& model, double volume_fraction,
                     const std::vector<double>& stresses, render::Colour colour)
{
    bool falls = false;
    for (double stress : stresses) {
        const double rate = shear_rate(model, volume_fraction, stress);
        if (!(rate > 0)) return;  // jammed, and above as well
        const bool now = thickening_slope(model, volume_fraction, stress) > 1;
        const bool first = stress == stresses.front();
        if (first || now != falls) {
            render::Series piece =
                line_series("", now ? render::Line::dashed : render::Line::solid, colour);
            if (!first) {  // joined to the piece before
                piece.x.push_back(plot.series.back().x.back());
                piece.y.push_back(plot.series.back().y.back());
            }
            plot.series.push_back(std::move(piece));
        }
        falls = now;
        plot.series.back().x.push_back(rate);
        plot.series.back().y.push_back(stress);
    }
}

bool is_empty(const render::Band& band)
{
    return band.x.size() < 2;
}

}

bool flows(const Measured& m)
{
    return !m.jammed && m.rate.mean > 0 && m.stress.mean > 0;
}

render::Plot sketch_plot(const Curves& curves, const WyartCates& model, const PictureSize& size)
{
    render::Plot plot = size.plot();
    plot.title = "Fit: $σ$*/$σ$_{0} = " + short_number(model.onset_stress) +
                 ", $ϕ$_{μ} = " + short_number(model.frictional_fraction) +
                 ", $ϕ$_{0} = " + short_number(model.frictionless_fraction) + ", exponent " +
                 short_number(model.exponent);
    plot.x.title = "shear rate $γ̇$/$γ̇$_{0}";
    plot.y.title = "shear stress $σ$/$σ$_{0}";
    plot.x.logarithmic = plot.y.logarithmic = true;
    Extent rates;
    for_each_point(curves, [&](double, const Measured& m) {
        if (flows(m)) rates.add(m.rate.mean);
    });
    const Extent range = drawn_stresses(curves), rate{rates.low / 4, rates.high * 1.5};
    plot.x.minimum = rate.low;
    plot.x.maximum = rate.high * 8;  // room for the legend
    plot.y.minimum = range.low;
    plot.y.maximum = range.high;

    const std::vector<double> stresses = spaced(range, 1000), levels = spaced(rate, 400);
    plot.bands = {
        region("jams at higher $σ$", red, levels, stresses,
               [&](double x, double stress) {
                   return shear_rate(model, model.frictional_fraction, stress) >= x;
               }),
        region("discontinuous, $γ̇$ falls", grey, levels, stresses, [&](double x, double stress) {
            return shear_rate(model, falling_fraction(model, stress), stress) >= x;
        })};
    std::erase_if(plot.bands, is_empty);

    bool jams = false;
    std::size_t number = 0;
    for (const auto& [volume_fraction, curve] : curves) {
        if (curve.by_stress.empty()) continue;
        const render::Colour colour = render::cycle_colour(number++);
        add_model_curve(plot, model, volume_fraction, stresses, colour);
        render::Series points =
            points_series("$ϕ$ = " + short_number(volume_fraction), render::Marker::circle, colour);
        render::Series jammed = points_series("", render::Marker::cross, colour);
        for (const auto& [imposed, m] : curve.by_stress) {
            if (flows(m)) {
                points.x.push_back(m.rate.mean);
                points.x_error.push_back(m.rate.standard_error);
                points.y.push_back(imposed);
            } else if (m.jammed) {  // side by side
                jammed.x.push_back(rate.low * std::pow(1.14, static_cast<double>(number)));
                jammed.y.push_back(imposed);
                jams = true;
            }
        }
        for (render::Series* series : {&points, &jammed})
            if (!series->x.empty()) plot.series.push_back(std::move(*series));
    }
    if (jams) plot.series.push_back(points_series("jammed, $γ̇$ = 0", render::Marker::cross, dark));
    if (const auto critical = critical_point(model)) {
        render::Series point = points_series("critical point", render::Marker::diamond, dark);
        point.x = {critical->shear_rate};
        point.y = {critical->stress};
        plot.series.push_back(std::move(point));
    }
    return plot;
}

namespace {

/// Where jamming_fraction of the drawn models lies at each stress.
void add_jamming_interval(render::Plot& plot, const std::vector<WyartCates>& drawn,
                          double confidence, const std::vector<double>& stresses)
{
    if (drawn.empty()) return;
    render::Series lower = line_series("its interval", render::Line::dotted, red);
    render::Series upper = line_series("", render::Line::dotted, red);
    for (double stress : stresses) {
        std::vector<double> fractions;
        for (const WyartCates& m : drawn) fractions.push_back(jamming_fraction(m, stress));
        const Interval interval = percentile_interval(fractions, confidence);
        lower.x.push_back(interval.lower);
        upper.x.push_back(interval.upper);
        lower.y.push_back(stress);
        upper.y.push_back(stress);
    }
    plot.series.push_back(std::move(lower));
    plot.series.push_back(std::move(upper));
}

}

render::Plot state_map_plot(const Curves& curves, const WyartCates& model,
                            const std::vector<WyartCates>& drawn, double confidence,
                            const PictureSize& size)
{
    render::Plot plot = size.plot();
    plot.title = "Flow states";
    plot.x.title = "volume fraction $ϕ$";
    plot.y.title = "shear stress $σ$/$σ$_{0}";
    plot.y.logarithmic = true;
    render::Series flowing = points_series("flows", render::Marker::circle, {0, 114, 178});
    render::Series jammed = points_series("jammed", render::Marker::cross, dark);
    Extent fractions;
    for_each_point(curves, [&](double volume_fraction, const Measured& m) {
        fractions.add(volume_fraction);
        if (!flows(m) && !m.jammed) return;
        render::Series& series = m.jammed ? jammed : flowing;
        series.x.push_back(volume_fraction);
        series.y.push_back(m.stress.mean);
    });
    constexpr double margin = 0.02, farthest = 0.15;
    const double right = std::min(model.frictionless_fraction, fractions.high + farthest);
    const Extent shown{fractions.low - margin, std::max(right, fractions.high) + margin};
    const Extent range = drawn_stresses(curves);
    plot.x.minimum = shown.low;
    plot.x.maximum = shown.high;
    plot.y.minimum = range.low;
    plot.y.maximum = range.high;

    const std::vector<double> stresses = spaced(range, 1000);
    const std::vector<double> all = spaced(shown, 1000);
    plot.bands = {
        region("does not flow", red, all, stresses,
               [&](double phi, double stress) { return phi >= jamming_fraction(model, stress); }),
        region("discontinuous, $γ̇$ falls", grey, all, stresses, [&](double phi, double stress) {
            return phi >= falling_fraction(model, stress) && phi < jamming_fraction(model, stress);
        })};
    std::erase_if(plot.bands, is_empty);
    render::Series jamming = line_series("$ϕ$_{J}($σ$), fitted", render::Line::solid, red);
    render::Series falling = line_series("$γ̇$ begins to fall", render::Line::dashed, dark);
    for (double stress : stresses) {
        jamming.x.push_back(jamming_fraction(model, stress));
        falling.x.push_back(falling_fraction(model, stress));
    }
    jamming.y = falling.y = stresses;
    plot.series = {std::move(jamming)};
    add_jamming_interval(plot, drawn, confidence, spaced(range, 100));
    if (critical_point(model)) plot.series.push_back(std::move(falling));
    for (render::Series* points : {&flowing, &jammed})
        if (!points->x.empty()) plot.series.push_back(std::move(*points));
    return plot;
}

}
