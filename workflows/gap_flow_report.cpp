#include "workflows/gap_flow_report.h"

#include "io/atomic_file.h"
#include "workflows/pictures.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow::workflows {

namespace {

double middle_rate(const Moment& m)
{
    return m.rate[m.rate.size() / 2];
}
double wall_rate(const Moment& m)
{
    return m.rate.front();
}

// Deviations are drawn, because those of a stable flow are too small to be read beside 1.
constexpr const char* deviation_title = "shear rate over that of uniform flow, minus 1";

/// At most `most` of the moments, evenly.
std::vector<const Moment*> thinned(const std::vector<Moment>& moments, std::size_t most)
{
    std::vector<const Moment*> result;
    const std::size_t every = (moments.size() + most - 1) / most;
    for (std::size_t k = 0; k < moments.size(); k += every) result.push_back(&moments[k]);
    return result;
}

render::Series series_of(const Development& d, const std::string& label,
                         double (*value)(const Moment&))
{
    render::Series series;
    series.label = label;
    series.line_width = 1.8;
    for (const Moment* m : thinned(d.moments, 4000)) {
        series.x.push_back(m->time);
        series.y.push_back(value(*m));
    }
    return series;
}

}

std::string series_text(const Development& development)
{
    std::string text =
        "# over uniform flow: strain (time times its rate), rates, stress; amplitude: of sin(pi "
        "y/H) "
        "in the rate\nstrain,mean_rate,middle_rate,wall_rate,middle_stress,amplitude\n";
    for (const Moment& m : development.moments) {
        text += io::number_text(m.time);
        for (double value :
             {m.mean_rate, middle_rate(m), wall_rate(m), m.middle_stress, m.amplitude})
            text += "," + io::number_text(value);
        text += "\n";
    }
    return text;
}

std::string field_text(const Development& development)
{
    std::string text =
        "# rate over that of uniform flow; columns: heights y/H, rows: strains\nstrain";
    const std::size_t cells = development.moments.front().rate.size();
    for (std::size_t j = 0; j < cells; ++j)
        text += "," + io::number_text((static_cast<double>(j) + 0.5) / static_cast<double>(cells));
    for (const Moment* m : thinned(development.moments, 1000)) {
        text += "\n" + io::number_text(m->time);
        for (double rate : m->rate) text += "," + io::number_text(rate);
    }
    return text + "\n";
}

render::Plot rates_plot(render::Plot plot, const Development& d)
{
    plot.y.title = deviation_title;
    plot.series = {
        series_of(d, "in the middle", [](const Moment& m) { return middle_rate(m) - 1; }),
        series_of(d, "at the walls", [](const Moment& m) { return wall_rate(m) - 1; }),
        series_of(d, "mean, what a rheometer shows",
                  [](const Moment& m) { return m.mean_rate - 1; })};
    double low = 0, high = 0;
    for (const render::Series& series : plot.series) {
        const auto [least, most] = std::minmax_element(series.y.begin(), series.y.end());
        low = std::min(low, *least);
        high = std::max(high, *most);
    }
    if (high > low) {  // room for the legend
        plot.y.minimum = low - 0.1 * (high - low);
        plot.y.maximum = high + 0.4 * (high - low);
    }
    return plot;
}

render::Plot growth_plot(render::Plot plot, const Development& d, double disturbance)
{
    plot.y.title = "amplitude of the first mode over the rate";
    plot.y.logarithmic = true;
    render::Series integrated = series_of(
        d, "integrated", [](const Moment& m) { return std::max(std::abs(m.amplitude), 1e-12); });
    render::Series theory;
    theory.label = "linear theory, growth " + short_number(d.expected.real()) + " $γ̇$";
    theory.line = render::Line::dashed;
    double largest = 0;
    for (double y : integrated.y) largest = std::max(largest, y);
    for (double x : integrated.x) {
        const double y = disturbance * std::exp(d.expected.real() * x);
        if (y > 2 * largest || y < 1e-12) break;
        theory.x.push_back(x);
        theory.y.push_back(y);
    }
    plot.y.minimum = std::max(1e-3 * disturbance, 1e-12);
    plot.series = {std::move(integrated), std::move(theory)};
    return plot;
}

render::Plot profiles_plot(render::Plot plot, const Development& d)
{
    plot.x.title = deviation_title;
    plot.y.title = "$y$/$H$";
    plot.y.minimum = 0;
    plot.y.maximum = 1;
    const double frequency = d.frequency > 0 ? d.frequency : std::abs(d.expected.imag());
    const double end = d.moments.back().time;
    const double period = frequency > 0 ? std::min(2 * std::acos(-1) / frequency, end) : end;
    constexpr int lines = 6;
    double lowest = 0, highest = 0;
    for (int k = 0; k < lines; ++k) {
        const double time = end - period + period * k / lines;
        const auto at = std::lower_bound(d.moments.begin(), d.moments.end() - 1, time,
                                         [](const Moment& m, double t) { return m.time < t; });
        render::Series series;
        series.label = "strain " + short_number(at->time);
        for (double rate : at->rate) {
            series.x.push_back(rate - 1);
            lowest = std::min(lowest, rate - 1);
            highest = std::max(highest, rate - 1);
        }
        for (std::size_t j = 0; j < at->rate.size(); ++j)
            series.y.push_back((static_cast<double>(j) + 0.5) /
                               static_cast<double>(at->rate.size()));
        plot.series.push_back(std::move(series));
    }
    if (highest > lowest) {  // room for the legend beside the lines
        plot.x.minimum = lowest - 0.05 * (highest - lowest);
        plot.x.maximum = highest + 0.35 * (highest - lowest);
    }
    plot.legend = render::Legend::top_right;
    return plot;
}

}
