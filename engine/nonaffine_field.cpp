#include "engine/nonaffine_field.h"

#include "engine/error.h"
#include "engine/pair_correlation.h"
#include "engine/pair_distances.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace sigmaflow {

namespace {

constexpr double inverse_e = 1 / std::numbers::e;
constexpr double in_cone = 0.75;  // squared cosine of 30 degrees

/// C of one direction in the bins that have pairs in every frame, from C(0) = 1 on; every mean is
/// then that of the same frames.
struct Curve {
    std::vector<double> distance, mean;      // of each knot
    std::vector<std::vector<double>> frame;  // [frame][knot]
};

Curve curve(std::span<const FieldCorrelation> frames, double largest_distance, int direction)
{
    Curve result{{0}, {1}, std::vector<std::vector<double>>(frames.size(), {1})};
    if (frames.empty()) return result;
    const std::size_t bins = frames.front().value[direction].size();
    for (std::size_t k = 0; k < bins; ++k) {
        if (std::any_of(frames.begin(), frames.end(),
                        [&](const FieldCorrelation& f) { return !(f.pairs[direction][k] > 0); }))
            continue;
        result.distance.push_back((static_cast<double>(k) + 0.5) * largest_distance /
                                  static_cast<double>(bins));
        double sum = 0;
        for (std::size_t f = 0; f < frames.size(); ++f) {
            result.frame[f].push_back(frames[f].value[direction][k]);
            sum += frames[f].value[direction][k];
        }
        result.mean.push_back(sum / static_cast<double>(frames.size()));
    }
    return result;
}

/// Where the mean first falls through a value: behind the knot `before`, at this share of the way
/// to the next one.
struct Crossing {
    std::size_t before = 0;
    double share = 0;
};

std::optional<Crossing> crossing(const Curve& c, double value)
{
    for (std::size_t k = 1; k < c.mean.size(); ++k)
        if (c.mean[k] < value)
            return Crossing{k - 1, (c.mean[k - 1] - value) / (c.mean[k - 1] - c.mean[k])};
    return std::nullopt;
}

double interpolated(const std::vector<double>& values, const Crossing& at)
{
    return values[at.before] + at.share * (values[at.before + 1] - values[at.before]);
}

}

std::vector<Vec3> nonaffine_field(const State& state, const std::vector<Vec3>& velocity)
{
    Vec3 sum = Vec3::Zero();
    double weight = 0;
    for (std::size_t i = 0; i < velocity.size(); ++i) {
        sum += state.radius[i] * velocity[i];
        weight += state.radius[i];
    }
    std::vector<Vec3> field = velocity;
    for (Vec3& w : field) w -= sum / weight;
    return field;
}

double mean_square(const std::vector<Vec3>& field)
{
    double sum = 0;
    for (const Vec3& w : field) sum += w.squaredNorm();
    return field.empty() ? 0 : sum / static_cast<double>(field.size());
}

Estimate product_of_means(std::span<const double> a, std::span<const double> b, double power)
{
    if (a.size() != b.size())
        throw Error(ErrorKind::input, "product_of_means",
                    "needs series of one length, got " + std::to_string(a.size()) + " and " +
                        std::to_string(b.size()));
    if (a.empty()) return {};
    const double mean_a = estimate_mean(a).mean, mean_b = estimate_mean(b).mean;
    if (mean_b == 0) throw Error(ErrorKind::numerics, "product_of_means", "the second mean is 0");
    const double factor = std::pow(mean_b, power);
    std::vector<double> linear;
    for (std::size_t k = 0; k < a.size(); ++k)
        linear.push_back(factor * (a[k] + power * mean_a * (b[k] / mean_b - 1)));
    return estimate_mean(linear);
}

FieldCorrelation field_correlation(const State& state, const std::vector<Vec3>& field,
                                   double largest_distance, int bins)
{
    const double half = largest_pair_distance(state.box);
    if (bins < 1 || !(largest_distance > 0) || largest_distance > half * (1 + 1e-12))
        throw Error(ErrorKind::input, "field_correlation",
                    "needs bins and a largest distance up to " + std::to_string(half) +
                        ", half the smallest box length, got " + std::to_string(bins) + " and " +
                        std::to_string(largest_distance));
    const double square = mean_square(field);
    if (!(square > 0) || !std::isfinite(square))
        throw Error(ErrorKind::input, "field_correlation",
                    "needs a field that is finite and not zero, its mean square is " +
                        std::to_string(square));
    FieldCorrelation result;
    for (int direction = 0; direction < 4; ++direction) {
        result.value[direction].assign(bins, 0);
        result.pairs[direction].assign(bins, 0);
    }
    PairDistances(state).each(largest_distance, [&](int i, int j, const Vec3& d, double r) {
        const int bin = std::min(static_cast<int>(r / largest_distance * bins), bins - 1);
        const double product = field[i].dot(field[j]) / square;
        result.value[0][bin] += product;
        result.pairs[0][bin] += 1;
        for (int axis = 0; axis < 3; ++axis) {
            if (d[axis] * d[axis] <= in_cone * r * r) continue;
            result.value[1 + axis][bin] += product;
            result.pairs[1 + axis][bin] += 1;
        }
    });
    for (int direction = 0; direction < 4; ++direction)
        for (int k = 0; k < bins; ++k)
            if (result.pairs[direction][k] > 0)
                result.value[direction][k] /= result.pairs[direction][k];
    return result;
}

MeanFieldCorrelation mean_field_correlation(std::span<const FieldCorrelation> frames,
                                            double largest_distance)
{
    MeanFieldCorrelation result;
    if (frames.empty()) return result;
    const std::size_t bins = frames.front().value[0].size();
    for (std::size_t k = 0; k < bins; ++k)
        result.distance.push_back((static_cast<double>(k) + 0.5) * largest_distance /
                                  static_cast<double>(bins));
    for (int direction = 0; direction < 4; ++direction)
        for (std::size_t k = 0; k < bins; ++k) {
            std::vector<double> series;
            double pairs = 0;
            for (const FieldCorrelation& f : frames) {
                if (!(f.pairs[direction][k] > 0)) continue;
                series.push_back(f.value[direction][k]);
                pairs += f.pairs[direction][k];
            }
            result.value[direction].push_back(estimate_mean(series));
            result.pairs[direction].push_back(pairs);
        }
    return result;
}

std::optional<CorrelationLength> correlation_length(std::span<const FieldCorrelation> frames,
                                                    double largest_distance, int direction)
{
    const Curve c = curve(frames, largest_distance, direction);
    const auto at = crossing(c, inverse_e);
    if (!at) return std::nullopt;
    const std::size_t k = at->before;
    if (k == 0) return CorrelationLength{c.distance[1], 0, true};
    const double slope = (c.mean[k] - c.mean[k + 1]) / (c.distance[k + 1] - c.distance[k]);
    std::vector<double> there;
    for (const auto& frame : c.frame) there.push_back(interpolated(frame, *at));
    return CorrelationLength{interpolated(c.distance, *at),
                             estimate_mean(there).standard_error / slope, false};
}

std::optional<IntegralLength> integral_length(std::span<const FieldCorrelation> frames,
                                              double largest_distance, int direction)
{
    const Curve c = curve(frames, largest_distance, direction);
    if (c.mean.size() < 2) return std::nullopt;
    const auto zero = crossing(c, 0);
    const Crossing end = zero.value_or(Crossing{c.mean.size() - 2, 1});
    std::vector<double> integrals;
    for (const auto& frame : c.frame) {
        double sum = 0;
        for (std::size_t k = 0; k < end.before; ++k)
            sum += (frame[k] + frame[k + 1]) / 2 * (c.distance[k + 1] - c.distance[k]);
        const double rest = end.share * (c.distance[end.before + 1] - c.distance[end.before]);
        integrals.push_back(sum + (frame[end.before] + interpolated(frame, end)) / 2 * rest);
    }
    const Estimate integral = estimate_mean(integrals);
    return IntegralLength{integral.mean, integral.standard_error, interpolated(c.distance, end),
                          zero.has_value()};
}

}
