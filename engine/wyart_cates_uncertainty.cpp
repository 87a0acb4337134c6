#include "engine/wyart_cates_uncertainty.h"

#include "engine/error.h"
#include "engine/random.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace sigmaflow {

namespace {

/// Box & Muller.
double normal(std::uint64_t seed, std::uint32_t stream, std::uint64_t counter)
{
    const double radius = std::sqrt(-2 * std::log(1 - uniform(seed, stream, 2 * counter)));
    return radius * std::cos(2 * std::numbers::pi * uniform(seed, stream, 2 * counter + 1));
}

/// One end of a profile: outwards from the best value until the deviance has risen by `rise`, then
/// inwards to where it has. The root of the rise is nearly linear in the logarithm of the value.
class ProfileWalk {
public:
    ProfileWalk(std::span<const WyartCatesPoint> points, const WyartCatesVariant& variant,
                const WyartCatesFit& best, WyartCatesParameter parameter, double rise)
        : points_(points),
          variant_(variant),
          best_(best),
          parameter_(parameter),
          target_(std::sqrt(rise))
    {
    }

    /// The logarithm of the end; `limit` if the deviance does not rise enough up to there.
    double end(double limit, double first_step) const
    {
        const double start = std::log(value_of(best_.model, parameter_));
        double inner = start, inner_root = 0, outer = start, outer_root = 0;
        WyartCatesFit at_inner = best_;
        for (double step = first_step;; step *= 2) {
            outer = limit > start ? std::min(inner + step, limit) : std::max(inner - step, limit);
            const WyartCatesFit fit = fit_at(outer, at_inner);
            outer_root = root(fit);
            if (outer_root >= target_) break;
            if (outer == limit) return limit;
            inner = outer;
            inner_root = outer_root;
            at_inner = fit;
        }
        constexpr double tolerance = 0.01;  // of z
        for (int k = 0; k < 30; ++k) {
            const double share =
                std::clamp((target_ - inner_root) / (outer_root - inner_root), 0.1, 0.9);
            const double middle = inner + share * (outer - inner);
            const WyartCatesFit fit = fit_at(middle, at_inner);
            const double here = root(fit);
            if (std::abs(here - target_) < tolerance) return middle;
            if (here < target_) {
                inner = middle;
                inner_root = here;
                at_inner = fit;
            } else {
                outer = middle;
                outer_root = here;
            }
        }
        return inner;
    }

private:
    WyartCatesFit fit_at(double logarithm, const WyartCatesFit& start) const
    {
        return refit_wyart_cates(points_, variant_, start,
                                 HeldParameter{parameter_, std::exp(logarithm)});
    }
    double root(const WyartCatesFit& fit) const
    {
        return std::sqrt(std::max(0., fit.deviance - best_.deviance));
    }

    std::span<const WyartCatesPoint> points_;
    const WyartCatesVariant& variant_;
    const WyartCatesFit& best_;
    WyartCatesParameter parameter_;
    double target_;
};

}

std::vector<WyartCates> bootstrap_wyart_cates(std::span<const WyartCatesPoint> points,
                                              const WyartCatesVariant& variant,
                                              const WyartCatesFit& fit, int samples,
                                              std::uint64_t seed)
{
    const double left = std::max(1, fit.flowing - fit.parameters);
    const double scatter = fit.scatter * std::sqrt(fit.flowing / left);
    std::vector<WyartCatesPoint> drawn(points.begin(), points.end());
    std::vector<WyartCates> result;
    for (int sample = 0; sample < samples; ++sample) {
        for (std::size_t k = 0; k < points.size(); ++k) {
            const WyartCatesPoint& p = points[k];
            if (p.jammed) continue;
            drawn[k].viscosity = viscosity(fit.model, p.volume_fraction, p.stress) *
                                 std::exp(std::hypot(p.relative_error, scatter) *
                                          normal(seed, static_cast<std::uint32_t>(sample), k));
        }
        result.push_back(refit_wyart_cates(drawn, variant, fit).model);
    }
    return result;
}

Interval percentile_interval(std::vector<double> values, double confidence)
{
    std::sort(values.begin(), values.end());
    const auto quantile = [&](double share) {
        const double place = share * static_cast<double>(values.size() - 1);
        const auto below = static_cast<std::size_t>(place);
        const std::size_t above = std::min(below + 1, values.size() - 1);
        return std::lerp(values[below], values[above], place - static_cast<double>(below));
    };
    return {quantile((1 - confidence) / 2), quantile((1 + confidence) / 2)};
}

Interval profile_interval(std::span<const WyartCatesPoint> points, const WyartCatesVariant& variant,
                          const WyartCatesFit& fit, WyartCatesParameter parameter,
                          double confidence)
{
    if (!is_free(variant, parameter))
        throw Error(ErrorKind::input, "profile of the Wyart-Cates model",
                    std::string(parameter_name(parameter)) + " is held");
    const double z = two_sided_quantile(1 - confidence);
    const ProfileWalk walk(points, variant, fit, parameter, z * z);
    const Limits limits = parameter_limits(points, parameter);
    constexpr double inside = 1e-6, first_step = 0.01;
    const double value = std::log(value_of(fit.model, parameter));
    const double lowest = std::min(std::log(limits.lower) + inside, value);
    const double highest = std::max(std::log(limits.upper) - inside, value);
    const double lower = walk.end(lowest, first_step), upper = walk.end(highest, first_step);
    return {std::exp(lower), std::exp(upper), lower == lowest, upper == highest};
}

std::vector<WyartCatesPoint> points_in(const FitRange& range,
                                       std::span<const WyartCatesPoint> points)
{
    std::vector<WyartCatesPoint> result;
    for (const WyartCatesPoint& p : points)
        if (p.volume_fraction <= range.highest_fraction && p.stress >= range.lowest_stress &&
            p.stress <= range.highest_stress)
            result.push_back(p);
    return result;
}

std::vector<FitRange> fit_ranges(std::span<const WyartCatesPoint> points)
{
    std::set<double> fractions, stresses;
    for (const WyartCatesPoint& p : points) {
        fractions.insert(p.volume_fraction);
        stresses.insert(p.stress);
    }
    if (points.empty()) return {};
    const FitRange all{*fractions.rbegin(), *stresses.begin(), *stresses.rbegin()};
    std::vector<FitRange> result{all};
    const auto add = [&](double FitRange::*end, double value) {
        result.push_back(all);
        result.back().*end = value;
    };
    auto fraction = fractions.rbegin();
    for (int dropped = 0; dropped < 2 && ++fraction != fractions.rend(); ++dropped)
        add(&FitRange::highest_fraction, *fraction);
    if (stresses.size() > 1) {
        add(&FitRange::lowest_stress, *std::next(stresses.begin()));
        add(&FitRange::highest_stress, *std::next(stresses.rbegin()));
    }
    return result;
}

}
