// render/particle_overlay.cpp
#include "render/particle_overlay.h"

#include "render/colour_map.h"
#include "render/framing.h"
#include "render/rich_text.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow::render {
namespace {

constexpr Colour line_colour{30, 30, 36};
constexpr double label_font = 34, tick_font = 30;
constexpr int colour_steps = 7;

double quantile(std::vector<double>& values, double share)
{
    const auto place = values.begin() + std::lround(share * (values.size() - 1));
    std::nth_element(values.begin(), place, values.end());
    return *place;
}

/// The bar with a pointed end where values lie beyond it.
Contour bar_contour(const Rectangle& bar, const ColourScale& scale)
{
    const double middle = (bar.left + bar.right) / 2, tip = 0.8 * bar.width();
    Contour contour{{bar.left, bar.bottom}, {bar.left, bar.top}};
    if (scale.values_above) contour.push_back({middle, bar.top - tip});
    contour.push_back({bar.right, bar.top});
    contour.push_back({bar.right, bar.bottom});
    if (scale.values_below) contour.push_back({middle, bar.bottom + tip});
    return contour;
}

void draw_bar_colours(Drawing& drawing, const Rectangle& bar, const ColourScale& scale)
{
    Contour contour = bar_contour(bar, scale);
    const double tip = bar.width();
    const auto slice = [&](double top, double bottom, double share) {
        drawing.fill({{contour}, {map_colour(scale.map, share)}, {}},
                     Rectangle{bar.left - 1, top, bar.right + 1, bottom});
    };
    const int slices = std::max(2, static_cast<int>(bar.height() / 2));
    if (scale.values_above) slice(bar.top - tip, bar.top, 1);
    for (int i = 0; i < slices; ++i)
        slice(std::round(bar.bottom - bar.height() * (i + 1) / slices),
              std::round(bar.bottom - bar.height() * i / slices), (i + 0.5) / slices);
    if (scale.values_below) slice(bar.bottom, bar.bottom + tip, 0);
    contour.push_back(contour[0]);
    contour.push_back(contour[1]);
    drawing.stroke({.points = contour, .ink = {line_colour}, .width = 1.0, .dashes = {}});
}

std::string tick_text(const Tick& tick, const ColourScale& scale)
{
    const double slack = 1e-9 * (scale.range.to - scale.range.from);
    if (scale.values_above && tick.value > scale.range.to - slack) return "≥ " + tick.label;
    if (scale.values_below && tick.value < scale.range.from + slack) return "≤ " + tick.label;
    return tick.label;
}

}

Colour ColourScale::colour(double value) const
{
    return map_colour(map, (value - range.from) / (range.to - range.from));
}

Range colour_range(std::vector<double> values, bool whole_numbers)
{
    std::erase_if(values, [](double value) { return !std::isfinite(value); });
    if (values.empty()) return {0, 1};
    const double high = quantile(values, 0.99);
    const double low = std::min(0.0, quantile(values, 0.01));
    if (high <= low) return {low, low + 1};
    // The same steps as those of the ticks, so that both ends of the bar are labelled.
    const double step =
        whole_numbers ? integer_step(high - low) : round_step(high - low, colour_steps);
    return {step * std::floor(low / step + 1e-6), step * std::ceil(high / step - 1e-6)};
}

std::string array_label(const std::string& array)
{
    if (array == "nonaffine_speed") return "|$U$ − $U$^{∞}| / ($γ̇$ $a$)";
    if (array == "nonaffine_velocity") return "|$U$ − $U$^{∞}| / ($γ̇$_{0} $a$)";
    if (array == "velocity") return "|$U$| / ($γ̇$_{0} $a$)";
    if (array == "angular_velocity") return "|$Ω$| / $γ̇$_{0}";
    if (array == "radius") return "radius / $a$";
    if (array == "contact_number") return "contacts per particle";
    if (array == "normal_force") return "normal force / $F$*";
    if (array == "stress") return "|stresslet| / ($σ$_{0} $a$^{3})";
    std::string words = array;
    std::replace(words.begin(), words.end(), '_', ' ');
    return words;
}

ParticleLayout particle_layout(int width, int height, bool title, bool colour_bar, bool triad)
{
    ParticleLayout layout;
    // Texts stay readable in small pictures, as long as there is room for particles beside them.
    const double readable = std::max(0.28, std::min(width / 1500.0, height / 1080.0));
    const double unit = std::min({readable, width / 560.0, height / 620.0});
    const double margin = 28 * unit, triad_width = 336 * unit, triad_height = 270 * unit;
    const double right = width - (colour_bar ? 350 * unit : margin), bottom = height - margin;
    const double top = title ? 104 * unit : margin;
    layout.unit = unit;
    layout.particles = {margin, top, right, bottom};
    layout.triad = {margin, bottom - triad_height, margin + triad_width, bottom};
    if (triad) {
        // A wide picture has room for it on the left, a tall one below.
        const double beside = std::min(right - margin - triad_width, bottom - top);
        const double below = std::min(right - margin, bottom - top - triad_height);
        if (beside >= below)
            layout.particles.left += triad_width;
        else
            layout.particles.bottom -= triad_height;
    }
    const double bar_left = right + 70 * unit;
    layout.colour_bar = {std::round(bar_left), std::round(188 * unit),
                         std::round(bar_left + 36 * unit), std::round(height - 150 * unit)};
    layout.title = {40 * unit, 70 * unit};
    layout.title_room = width - 80 * unit;
    return layout;
}

void draw_colour_bar(Drawing& drawing, const Fonts& fonts, const ColourScale& scale,
                     const ParticleLayout& layout)
{
    const double unit = layout.unit, size = tick_font * unit;
    const Rectangle& bar = layout.colour_bar;
    draw_bar_colours(drawing, bar, scale);
    const std::vector<Tick> ticks =
        scale.whole_numbers ? integer_ticks(scale.range) : linear_ticks(scale.range, colour_steps);
    for (const Tick& tick : ticks) {
        if (tick.label.empty()) continue;
        const double share = (tick.value - scale.range.from) / (scale.range.to - scale.range.from);
        const double y = bar.bottom - share * bar.height();
        drawing.stroke({.points = {{bar.right, y}, {bar.right + 9 * unit, y}},
                        .ink = {line_colour},
                        .width = std::max(1.0, 2 * unit),
                        .dashes = {}});
        draw_text(drawing, fonts, tick_text(tick, scale),
                  {bar.right + 18 * unit, y + 0.5 * capital_height * size}, {.size = size});
    }
    // Centred on the bar and its numbers, but never cut.
    const double from = layout.particles.right + 8 * unit, to = drawing.width - 20 * unit;
    const double width = text_width(fonts, scale.label);
    const double label_size = std::min(label_font * unit, (to - from) / std::max(width, 1e-6));
    const double half = 0.5 * label_size * width;
    const double centre = std::clamp(bar.left + 56 * unit, from + half, to - half + 1e-9);
    draw_text(drawing, fonts, scale.label, {centre, bar.top - 58 * unit},
              {.size = label_size, .align = Align::centre});
}

void draw_title(Drawing& drawing, const Fonts& fonts, const std::string& title,
                const ParticleLayout& layout)
{
    const double width = text_width(fonts, title);
    draw_text(drawing, fonts, title, layout.title,
              {.size = std::min(36 * layout.unit, layout.title_room / std::max(width, 1e-6))});
}

}
