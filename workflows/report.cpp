#include "workflows/report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace sigmaflow::workflows {

using Json = nlohmann::ordered_json;

namespace {

double number_or_nan(const Json& object, const char* key)
{
    const auto it = object.find(key);
    return it != object.end() && it->is_number() ? it->get<double>() : std::nan("");
}

std::string padded(std::string text, std::size_t width)
{
    text.resize(std::max(width, text.size()), ' ');
    return text;
}

std::string format(const char* pattern, double value)
{
    char text[64];
    std::snprintf(text, sizeof text, pattern, value);
    return text;
}

}

bool is_mean(const Json& entry)
{
    return entry.is_object() && entry.contains("mean");
}

std::string mean_text(const Json& entry, const std::string& between)
{
    return with_error(number_or_nan(entry, "mean"), number_or_nan(entry, "standard_error"),
                      between);
}

std::string with_error(double value, double error, const std::string& between)
{
    if (!std::isfinite(value)) return "undefined";
    // an imposed quantity scatters by rounding only
    if (!(error > 1e-12 * std::abs(value)) || !std::isfinite(error)) return format("%.4g", value);
    const int decimals = 1 - static_cast<int>(std::floor(std::log10(error)));
    if (decimals > 6 || std::abs(value) >= 1e6 || error >= 1e6)
        return format("%.3g", value) + between + format("%.1e", error);
    const double unit = std::pow(10, -decimals);
    const auto rounded = [&](double number) {
        char text[64];
        std::snprintf(text, sizeof text, "%.*f", std::max(0, decimals),
                      decimals < 0 ? unit * std::round(number / unit) : number);
        return std::string(text);
    };
    return rounded(value) + between + rounded(error);
}

std::string one_line(const Json& step)
{
    std::string result = step.contains("outcome") ? step["outcome"].get<std::string>() : "done";
    if (step.contains("strain"))
        result += ", strain " + format("%.4g", number_or_nan(step, "strain"));
    if (step.contains("shear_rate") && step["shear_rate"].is_object())
        result += ", shear rate " + mean_text(step["shear_rate"]);
    if (step.contains("last_shear_rate"))
        result += ", shear rate " + format("%.4g", number_or_nan(step, "last_shear_rate"));
    if (step.contains("volume_fraction") && !step.contains("outcome"))
        result += ", volume fraction " + format("%.4g", number_or_nan(step, "volume_fraction"));
    return result;
}

std::string table(const Json& summary)
{
    std::string text;
    for (const auto& [name, step] : summary["steps"].items()) {
        if (std::none_of(step.begin(), step.end(), is_mean)) continue;
        text += name + ": " + one_line(step);
        if (step.contains("averages_from_strain"))
            text += ", averages from strain " +
                    format("%.4g", number_or_nan(step, "averages_from_strain"));
        text += "\n";
        for (const auto& [quantity, entry] : step.items()) {
            if (!is_mean(entry)) continue;
            text += "  " + padded(quantity, 30) + padded(mean_text(entry), 24) +
                    entry["unit"].get<std::string>() + "\n";
        }
        if (step.contains("rms_deviation"))
            text += "  " + padded("rms deviation from uniform", 30) +
                    format("%.4g", number_or_nan(step, "rms_deviation")) + "\n";
    }
    return text;
}

}
