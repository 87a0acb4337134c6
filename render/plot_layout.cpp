// render/plot_layout.cpp -- ranges of the axes and the place of the frame.
#include "engine/error.h"
#include "render/plot_parts.h"
#include "render/rich_text.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sigmaflow::render {
namespace {

/// The smallest range that holds all finite values an axis can show.
class Extremes {
public:
    explicit Extremes(bool logarithmic) : logarithmic_(logarithmic) {}

    void add(double value)
    {
        if (!std::isfinite(value) || (logarithmic_ && value <= 0)) return;
        range_.from = std::min(range_.from, value);
        range_.to = std::max(range_.to, value);
    }
    void add(const std::vector<double>& values, const std::vector<double>& errors)
    {
        for (std::size_t i = 0; i < values.size(); ++i) {
            add(values[i]);
            if (errors.empty() || !std::isfinite(errors[i])) continue;
            add(values[i] - errors[i]);
            add(values[i] + errors[i]);
        }
    }
    /// With room below and above, as shares of the range. A default range if there is nothing.
    Range range(double below, double above) const
    {
        if (range_.from > range_.to) return logarithmic_ ? Range{0.1, 1} : Range{0, 1};
        if (logarithmic_) {
            const double ratio = range_.to / range_.from;
            return {range_.from / std::pow(ratio, below), range_.to * std::pow(ratio, above)};
        }
        const double length = range_.to - range_.from;
        // Quantities that are never negative keep their zero.
        const bool near_zero = range_.from >= 0 && range_.from < 0.25 * length;
        return {near_zero ? 0 : range_.from - below * length, range_.to + above * length};
    }

private:
    bool logarithmic_;
    Range range_{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
};

Range x_extremes(const Plot& plot)
{
    Extremes extremes(plot.x.logarithmic);
    for (const Series& series : plot.series) extremes.add(series.x, series.x_error);
    for (const Band& band : plot.bands) extremes.add(band.x, {});
    for (const Span& span : plot.spans) {
        extremes.add(span.from);
        extremes.add(span.to);
    }
    if (plot.grid) extremes.add(plot.grid->x, {});
    // Lines may begin and end on the frame, markers not.
    const bool markers = std::any_of(plot.series.begin(), plot.series.end(), [](const Series& s) {
        return s.marker != Marker::none && !s.x.empty();
    });
    const double room = markers ? 0.02 : 0;
    return extremes.range(room, room);
}

Range y_extremes(const Plot& plot)
{
    Extremes extremes(plot.y.logarithmic);
    for (const Series& series : plot.series) extremes.add(series.y, series.y_error);
    for (const Band& band : plot.bands) {
        extremes.add(band.lower, {});
        extremes.add(band.upper, {});
    }
    if (plot.grid) {
        extremes.add(plot.grid->y, {});
        return extremes.range(0, 0);
    }
    // Labels of spans stand at the top of the frame, above the data.
    return extremes.range(0.04, plot.spans.empty() ? 0.04 : 0.12);
}

constexpr double bar_room = 190;  // right of the frame, for the colour bar of a grid

Range axis_range(const PlotAxis& axis, Range data, const std::string& where)
{
    Range range = axis.logarithmic ? round_log_range(data) : round_linear_range(data);
    if (axis.minimum) range.from = *axis.minimum;
    if (axis.maximum) range.to = *axis.maximum;
    std::string text = "[";
    text += std::to_string(range.from) + ", " + std::to_string(range.to) + "]";
    if (!std::isfinite(range.from) || !std::isfinite(range.to) || range.from >= range.to)
        throw Error(ErrorKind::input, where, "the range " + text + " is empty");
    if (axis.logarithmic && range.from <= 0)
        throw Error(ErrorKind::input, where,
                    "a logarithmic axis must begin above 0, the range is " + text);
    return range;
}

double widest_label(const std::vector<Tick>& ticks, const Fonts& fonts)
{
    double width = 0;
    for (const Tick& tick : ticks) width = std::max(width, text_width(fonts, tick.label));
    return width;
}

}

double Scale::pixel(double value) const
{
    double share = (value - range.from) / (range.to - range.from);
    if (logarithmic) {
        if (!(value > 0)) return std::numeric_limits<double>::quiet_NaN();
        share = std::log(value / range.from) / std::log(range.to / range.from);
    }
    return first_pixel + std::clamp(share, -100.0, 100.0) * (last_pixel - first_pixel);
}

std::vector<Tick> Scale::ticks() const
{
    return logarithmic ? log_ticks(range) : linear_ticks(range);
}

PlotLayout plot_layout(const Plot& plot, const Fonts& fonts)
{
    PlotLayout layout;
    layout.unit = std::max(0.3, std::min(plot.width / 1300.0, plot.height / 1080.0));
    layout.x.logarithmic = plot.x.logarithmic;
    layout.y.logarithmic = plot.y.logarithmic;
    layout.x.range = axis_range(plot.x, x_extremes(plot), "x axis");
    layout.y.range = axis_range(plot.y, y_extremes(plot), "y axis");

    const double unit = layout.unit, tick_font = layout.tick_font();
    const auto x_ticks = layout.x.ticks();
    double left = 24 * unit + 16 * unit + widest_label(layout.y.ticks(), fonts) * tick_font;
    if (!plot.y.title.empty()) left += 1.45 * layout.title_font();
    const double beside_bar = plot.grid ? bar_room * unit : 0;
    const double right =
        beside_bar +
        std::max(30 * unit, 12 * unit + 0.5 * tick_font * text_width(fonts, x_ticks.back().label));
    const double top = plot.title.empty() ? 34 * unit : 34 * unit + 1.4 * layout.title_font();
    double bottom = 24 * unit + 1.35 * tick_font;
    if (!plot.x.title.empty()) bottom += 1.55 * layout.title_font();
    // On the pixel grid the frame is sharp.
    layout.frame = {std::round(left), std::round(top), std::round(plot.width - right),
                    std::round(plot.height - bottom)};
    if (layout.frame.width() < 10 || layout.frame.height() < 10)
        throw Error(ErrorKind::input, "plot",
                    "a picture of " + std::to_string(plot.width) + " x " +
                        std::to_string(plot.height) + " pixels has no room beside its labels");
    const double bar_left = std::round(layout.frame.right + 40 * unit);
    layout.colour_bar = {bar_left, layout.frame.top + std::round(86 * unit),
                         bar_left + std::round(36 * unit), layout.frame.bottom};
    layout.x.first_pixel = layout.frame.left;
    layout.x.last_pixel = layout.frame.right;
    layout.y.first_pixel = layout.frame.bottom;
    layout.y.last_pixel = layout.frame.top;
    return layout;
}

}
