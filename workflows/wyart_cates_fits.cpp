#include "workflows/wyart_cates_fits.h"

#include "io/atomic_file.h"
#include "workflows/pictures.h"

#include <algorithm>

namespace sigmaflow::workflows {

namespace {

constexpr std::size_t parameter_count = wyart_cates_parameters.size();

std::string csv_head()
{
    std::string text =
        "# one row for each variant of the model and each range of the data; _lower, _upper: "
        "bootstrap interval, _profile_lower, _profile_upper: profile likelihood, empty: held; rms, "
        "scatter: of ln viscosity; akaike: to be compared between rows of one range only\n"
        "highest_volume_fraction,lowest_stress,highest_stress,flowing,jammed,rms,scatter,akaike,"
        "converged";
    for (WyartCatesParameter p : wyart_cates_parameters)
        for (const char* end : {"", "_lower", "_upper", "_profile_lower", "_profile_upper"})
            text += "," + std::string(parameter_name(p)) + end;
    return text +
           ",critical_fraction,critical_fraction_lower,critical_fraction_upper,"
           "critical_stress\n";
}

std::string csv_row(const Row& row, double confidence)
{
    std::string text;
    const auto add = [&](double value) { text += io::number_text(value) + ","; };
    const auto add_interval = [&](const std::optional<Interval>& i) {
        text += i ? io::number_text(i->lower) + "," + io::number_text(i->upper) + "," : ",,";
    };
    for (double value : {row.range.highest_fraction, row.range.lowest_stress,
                         row.range.highest_stress, double(row.fit.flowing), double(row.fit.jammed),
                         row.fit.rms, row.fit.scatter, row.fit.akaike})
        add(value);
    text += row.fit.converged ? "yes," : "no,";
    for (std::size_t k = 0; k < parameter_count; ++k) {
        const WyartCatesParameter p = wyart_cates_parameters[k];
        add(value_of(row.fit.model, p));
        add_interval(is_free(row.variant, p) && !row.drawn.empty()
                         ? std::optional(percentile_interval(row.drawn_values(p), confidence))
                         : std::nullopt);
        add_interval(row.profile[k]);
    }
    const auto critical = critical_point(row.fit.model);
    const std::vector<double> fractions = row.drawn_values(critical_fraction);
    if (critical) add(critical->volume_fraction);
    if (!critical) text += ",";
    add_interval(critical && !fractions.empty()
                     ? std::optional(percentile_interval(fractions, confidence))
                     : std::nullopt);
    return text + (critical ? io::number_text(critical->stress) : "") + "\n";
}

/// The fit of the parameter in other variants or ranges whose interval is apart from this one.
std::optional<double> contradiction(const std::vector<Row>& rows, WyartCatesParameter p,
                                    const Interval& i, double confidence)
{
    std::optional<double> farthest;
    const auto apart = [&](double value) { return std::max(i.lower - value, value - i.upper); };
    for (const Row& row : rows) {
        if (!is_free(row.variant, p)) continue;
        const Interval other = percentile_interval(row.drawn_values(p), confidence);
        const double value = value_of(row.fit.model, p);
        if ((other.lower > i.upper || other.upper < i.lower) &&
            (!farthest || apart(value) > apart(*farthest)))
            farthest = value;
    }
    return farthest;
}

}

std::optional<double> critical_fraction(const WyartCates& model)
{
    const auto critical = critical_point(model);
    return critical ? std::optional(critical->volume_fraction) : std::nullopt;
}

std::string csv_text(const std::vector<Row>& rows, double confidence)
{
    std::string text = csv_head();
    for (const Row& row : rows) text += csv_row(row, confidence);
    return text;
}

std::string words(const WyartCatesVariant& v)
{
    return (v.exponent ? "exponent " + short_number(*v.exponent) : "free exponent") +
           (v.sharpness ? ", sharpness " + short_number(*v.sharpness) : ", free sharpness");
}

std::vector<std::string> verdict(const std::vector<Row>& rows, const Row& best,
                                 const std::vector<WyartCatesPoint>& points, double confidence)
{
    std::vector<std::string> texts{words(best.variant) + " has the lowest Akaike number"};
    if (!best.fit.converged) texts.push_back("the fit has not converged");
    for (std::size_t k = 0; k < parameter_count; ++k) {
        const auto& i = best.profile[k];
        if (!i) continue;
        const std::string name(parameter_name(wyart_cates_parameters[k]));
        if (i->open_below || i->open_above)
            texts.push_back("the data do not determine " + name +
                            ": its interval reaches the limit of the fit" +
                            (i->open_below && i->open_above ? " on both sides"
                             : i->open_below ? ", it is at most " + short_number(i->upper)
                                             : ", it is at least " + short_number(i->lower)));
        const auto other = contradiction(rows, wyart_cates_parameters[k], *i, confidence);
        if (other)
            texts.push_back(name + " depends on the variant or the range of the data, e.g. " +
                            short_number(*other) + " instead of " +
                            short_number(value_of(best.fit.model, wyart_cates_parameters[k])) +
                            ", with intervals apart");
    }
    const auto jams_too_early = std::count_if(points.begin(), points.end(), [&](const auto& p) {
        return p.jammed && shear_rate(best.fit.model, p.volume_fraction, p.stress) > 0;
    });
    if (jams_too_early > 0)
        texts.push_back(std::to_string(jams_too_early) + " of " + std::to_string(best.fit.jammed) +
                        " jammed points flow in the model, with a high viscosity");
    if (!critical_point(best.fit.model))
        texts.push_back("the rate falls at no volume fraction that flows at all stresses");
    return texts;
}

}
