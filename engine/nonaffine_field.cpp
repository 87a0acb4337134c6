#include "engine/nonaffine_field.h"

#include "engine/error.h"
#include "engine/pair_correlation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace sigmaflow {

namespace {

constexpr double inverse_e = 1 / std::numbers::e;
constexpr double in_cone = 0.75;  // squared cosine of 30 degrees

struct Knot {
    double distance;
    std::size_t bin;
};

/// Bins that have pairs in every frame, where the mean is that of one and the same set of frames.
std::vector<Knot> common_bins(std::span<const FieldCorrelation> frames, double width, int direction)
{
    std::vector<Knot> result;
    for (std::size_t k = 0; k < frames.front().value[direction].size(); ++k)
        if (std::all_of(frames.begin(), frames.end(),
                        [&](const FieldCorrelation& f) { return f.pairs[direction][k] > 0; }))
            result.push_back({(static_cast<double>(k) + 0.5) * width, k});
    return result;
}

double mean_value(std::span<const FieldCorrelation> frames, int direction, std::size_t bin)
{
    double sum = 0;
    for (const FieldCorrelation& f : frames) sum += f.value[direction][bin];
    return sum / static_cast<double>(frames.size());
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
    const Images images(state.box);
    const double reach = largest_distance * largest_distance;
    for (int i = 0; i < state.size(); ++i)
        for (int j = i + 1; j < state.size(); ++j) {
            const Vec3 d = images.separation(state.position[i], state.position[j]).d;
            const double r2 = d.squaredNorm();
            if (r2 >= reach) continue;
            const int bin =
                std::min(static_cast<int>(std::sqrt(r2) / largest_distance * bins), bins - 1);
            const double product = field[i].dot(field[j]) / square;
            const auto add = [&](int direction) {
                result.value[direction][bin] += product;
                result.pairs[direction][bin] += 1;
            };
            add(0);
            for (int axis = 0; axis < 3; ++axis)
                if (d[axis] * d[axis] > in_cone * r2) add(1 + axis);
        }
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
    if (frames.empty()) return std::nullopt;
    const double width =
        largest_distance / static_cast<double>(frames.front().value[direction].size());
    double before = 0, value_before = 1;
    std::optional<std::size_t> bin_before;
    for (const auto& [distance, bin] : common_bins(frames, width, direction)) {
        const double value = mean_value(frames, direction, bin);
        if (value < inverse_e) {
            const double share = (value_before - inverse_e) / (value_before - value);
            const double slope = (value_before - value) / (distance - before);
            std::vector<double> there;
            for (const FieldCorrelation& f : frames) {
                const double first = bin_before ? f.value[direction][*bin_before] : 1;
                there.push_back(first + share * (f.value[direction][bin] - first));
            }
            return CorrelationLength{before + share * (distance - before),
                                     estimate_mean(there).standard_error / slope, !bin_before};
        }
        before = distance;
        value_before = value;
        bin_before = bin;
    }
    return std::nullopt;
}

}
