// render/ticks.cpp
#include "render/ticks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace sigmaflow::render {
namespace {

constexpr double slack = 1e-9;  // of a step: lets 0.1 * 3 count as 0.3
const std::string minus = "\u2212", times = "\u00d7";

double power_of_ten(int exponent)
{
    return std::pow(10.0, exponent);
}

/// Digits after the point that a multiple of step needs.
int decimals_of(double step)
{
    for (int decimals = 0; decimals < 15; ++decimals) {
        const double scaled = step * power_of_ten(decimals);
        if (std::abs(scaled - std::round(scaled)) < 1e-6 * scaled) return decimals;
    }
    return 15;
}

std::string integer_text(int value)
{
    std::string text = value < 0 ? minus : "";
    text += std::to_string(std::abs(value));
    return text;
}

std::string power_text(int exponent)
{
    std::string text = "10^{";
    text += integer_text(exponent);
    text += '}';
    return text;
}

/// One label style for the whole axis: plain numbers, or multiples of one power of ten.
std::string axis_label(double value, double step, double largest)
{
    if (largest < 1e5 && step >= 0.9e-4) return fixed_label(value, decimals_of(step));
    if (value == 0) return "0";
    const int exponent = static_cast<int>(std::floor(std::log10(largest) + slack));
    const double unit = power_of_ten(exponent);
    return fixed_label(value / unit, decimals_of(step / unit)) + times + power_text(exponent);
}

int minor_parts(double step)
{
    const double mantissa =
        step / power_of_ten(static_cast<int>(std::floor(std::log10(step) + slack)));
    return std::lround(mantissa) == 2 && std::abs(mantissa - 2) < 0.1 ? 4 : 5;
}

std::vector<Tick> stepped_ticks(Range range, double step, int parts)
{
    const double largest = std::max(std::abs(range.from), std::abs(range.to));
    const double minor = step / parts;
    std::vector<Tick> ticks;
    const auto first = static_cast<long long>(std::ceil(range.from / minor - slack));
    const auto last = static_cast<long long>(std::floor(range.to / minor + slack));
    for (long long i = first; i <= last; ++i) {
        const bool major = i % parts == 0;
        const double value = major ? i / parts * step : i * minor;
        ticks.push_back({value, major ? axis_label(value, step, largest) : ""});
    }
    return ticks;
}

std::string short_decade_label(int mantissa, int exponent)
{
    if (exponent >= -3 && exponent <= 3)
        return fixed_label(mantissa * power_of_ten(exponent), std::max(0, -exponent));
    if (mantissa == 1) return power_label(exponent);
    return std::to_string(mantissa) + times + power_text(exponent);
}

}

double round_step(double length, int most_steps)
{
    const double smallest = length / most_steps;
    const double power = power_of_ten(static_cast<int>(std::floor(std::log10(smallest))));
    for (double mantissa : {1.0, 2.0, 2.5, 5.0})
        if (mantissa * power >= smallest * (1 - slack)) return mantissa * power;
    return 10 * power;
}

std::vector<Tick> linear_ticks(Range range, int most_steps)
{
    const double step = round_step(range.to - range.from, most_steps);
    return stepped_ticks(range, step, minor_parts(step));
}

double integer_step(double length)
{
    const double step = round_step(length, 8);
    return step < 1 ? 1 : step == 2.5 ? 5 : step;
}

std::vector<Tick> integer_ticks(Range range)
{
    return stepped_ticks(range, integer_step(range.to - range.from), 1);
}

std::vector<Tick> log_ticks(Range range)
{
    const double decades = std::log10(range.to / range.from);
    const bool short_axis = decades < 2;
    const int stride = std::max(1, static_cast<int>(std::ceil(decades / 8)));
    std::vector<Tick> ticks;
    int labels = 0;
    for (int e = static_cast<int>(std::floor(std::log10(range.from) - slack));
         e <= std::log10(range.to) + slack; ++e) {
        for (int m = 1; m < 10; ++m) {
            const double value = m * power_of_ten(e);
            if (value < range.from * (1 - slack) || value > range.to * (1 + slack)) continue;
            if (stride > 1 && m > 1) continue;  // no room for minor ticks
            std::string label;
            if (short_axis && (m == 1 || m == 2 || m == 5))
                label = short_decade_label(m, e);
            else if (m == 1 && e % stride == 0)
                label = power_label(e);
            labels += !label.empty();
            ticks.push_back({value, label});
        }
    }
    return labels >= 3 || !short_axis ? ticks : linear_ticks(range, 4);
}

Range round_linear_range(Range data)
{
    if (data.from == data.to) {
        const double room = data.from == 0 ? 1 : 0.5 * std::abs(data.from);
        return {data.from - room, data.to + room};
    }
    const double step = round_step(data.to - data.from, 6);
    const double minor = step / minor_parts(step);
    return {minor * std::floor(data.from / minor + 1e-6),
            minor * std::ceil(data.to / minor - 1e-6)};
}

Range round_log_range(Range data)
{
    const auto mantissa_power = [](double value) {
        const double power = power_of_ten(static_cast<int>(std::floor(std::log10(value) + slack)));
        return std::pair(value / power, power);
    };
    if (data.from == data.to) return {data.from / 2, data.to * 2};
    const auto [low, low_power] = mantissa_power(data.from);
    const auto [high, high_power] = mantissa_power(data.to);
    const double from = low >= 5 - slack ? 5 : low >= 2 - slack ? 2 : 1;
    const double to = high <= 1 + slack ? 1 : high <= 2 + slack ? 2 : high <= 5 + slack ? 5 : 10;
    return {from * low_power, to * high_power};
}

std::string fixed_label(double value, int decimals)
{
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", decimals, std::abs(value));
    bool zero = true;
    for (const char* letter = text; *letter; ++letter)
        if (*letter >= '1' && *letter <= '9') zero = false;
    return (value < 0 && !zero ? minus : "") + text;
}

std::string power_label(int exponent)
{
    if (exponent == 0) return "1";
    if (exponent == 1) return "10";
    return power_text(exponent);
}

}
