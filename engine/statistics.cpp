#include "engine/statistics.h"

#include "engine/error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

namespace sigmaflow {
namespace {

constexpr double window_factor = 5;            // c of Sokal's window w >= c tau(w)
constexpr double fewest_effective = 20;        // below this the error itself is mostly noise
constexpr int start_up_candidates = 50;        // a finer search would mostly choose among noise
constexpr int longest_start_up_series = 2000;  // longer ones are averaged in blocks: cost n^2

double mean_of(std::span<const double> series)
{
    return std::accumulate(series.begin(), series.end(), 0.0) / static_cast<double>(series.size());
}

void require_finite(std::span<const double> series)
{
    const auto bad = std::find_if_not(series.begin(), series.end(),
                                      [](double value) { return std::isfinite(value); });
    if (bad != series.end())
        throw Error(ErrorKind::numerics, "sample " + std::to_string(bad - series.begin()),
                    "must be a finite number, got " + std::to_string(*bad));
}

std::vector<double> deviations_from_mean(std::span<const double> series)
{
    const double mean = mean_of(series);
    std::vector<double> deviation(series.size());
    std::transform(series.begin(), series.end(), deviation.begin(),
                   [mean](double value) { return value - mean; });
    return deviation;
}

/// Nothing but the rounding of the mean is left.
bool never_changes(std::span<const double> series)
{
    const auto [low, high] = std::minmax_element(series.begin(), series.end());
    const double scale = std::max(std::abs(*low), std::abs(*high));
    return *high - *low <= 4 * std::numeric_limits<double>::epsilon() * scale;
}

double autocovariance(const std::vector<double>& deviation, std::size_t lag)
{
    const auto first = deviation.begin();
    const double sum =
        std::inner_product(first + static_cast<std::ptrdiff_t>(lag), deviation.end(), first, 0.0);
    return sum / static_cast<double>(deviation.size() - lag);
}

struct Correlation {
    double variance;  // of one sample, bias removed
    double time;      // tau
    bool converged;   // the window closed well inside the series
};

/// Needs a series that changes.
Correlation integrated_correlation(std::span<const double> series)
{
    const std::vector<double> deviation = deviations_from_mean(series);
    const double n = static_cast<double>(series.size());
    const double variance = autocovariance(deviation, 0);
    const std::size_t longest_window = series.size() / 2;

    double sum = variance / 2;  // tau * variance so far
    std::size_t window = 0;
    bool converged = false;
    while (!converged && window < longest_window) {
        ++window;
        sum += autocovariance(deviation, window);
        converged = static_cast<double>(window) >= window_factor * std::max(sum / variance, 0.5);
    }
    // Every autocovariance is too small by the squared error of the mean, 2 tau variance / n.
    const double shift = std::max(0.0, 2 * sum / n);
    const double unbiased_variance = variance + shift;
    sum += (static_cast<double>(window) + 0.5) * shift;
    return {unbiased_variance, std::max(0.5, sum / unbiased_variance), converged};
}

struct Blocking {
    double error;
    bool converged;  // a block length with enough blocks was found
};

/// Needs a series that changes. Without convergence: the largest error of all block lengths.
Blocking blocking(std::span<const double> series)
{
    const double n = static_cast<double>(series.size());
    double largest = 0, first = 0;
    for (const BlockError& block : block_errors(series)) {
        if (block.length == 1) first = block.error;
        largest = std::max(largest, block.error);
        const double length = block.length;
        const double inefficiency = std::pow(block.error / first, 2);  // -> 2 tau
        if (length * length * length > 2 * n * inefficiency * inefficiency)
            return {block.error, true};
    }
    return {largest, false};
}

/// Samples that count in the search for the start-up.
double effective_samples(std::span<const double> series)
{
    const double n = static_cast<double>(series.size());
    return never_changes(series) ? n : n / (2 * integrated_correlation(series).time);
}

std::vector<double> block_means(std::span<const double> series, std::size_t length)
{
    std::vector<double> means(series.size() / length);
    for (std::size_t k = 0; k < means.size(); ++k)
        means[k] = mean_of(series.subspan(k * length, length));
    return means;
}

}

Estimate estimate_mean(std::span<const double> series)
{
    require_finite(series);
    Estimate result;
    result.used = static_cast<int>(series.size());
    if (series.empty()) return result;
    result.mean = mean_of(series);
    result.effective_samples = 1;
    if (series.size() < 2 || never_changes(series)) return result;

    const Correlation correlation = integrated_correlation(series);
    const Blocking blocked = blocking(series);
    const double n = static_cast<double>(series.size());
    result.correlation_time = correlation.time;
    result.effective_samples = n / (2 * correlation.time);
    result.autocorrelation_error = std::sqrt(correlation.variance / result.effective_samples);
    result.blocking_error = blocked.error;
    result.standard_error = std::max(result.autocorrelation_error, result.blocking_error);
    result.reliable =
        correlation.converged && blocked.converged && result.effective_samples >= fewest_effective;
    return result;
}

std::vector<double> autocorrelation(std::span<const double> series, int lags)
{
    require_finite(series);
    std::vector<double> result;
    if (series.empty()) return result;
    const std::vector<double> deviation = deviations_from_mean(series);
    const bool changes = !never_changes(series);
    const double variance = autocovariance(deviation, 0);
    const auto last = std::min(static_cast<std::size_t>(std::max(lags, 0)), series.size() - 1);
    for (std::size_t lag = 0; lag <= last; ++lag)
        result.push_back(changes ? autocovariance(deviation, lag) / variance : (lag == 0 ? 1 : 0));
    return result;
}

std::vector<BlockError> block_errors(std::span<const double> series)
{
    require_finite(series);
    std::vector<BlockError> result;
    std::vector<double> block(series.begin(), series.end());
    for (int length = 1; block.size() >= 2; length *= 2) {
        const double blocks = static_cast<double>(block.size());
        const double square = autocovariance(deviations_from_mean(block), 0) / (blocks - 1);
        result.push_back({length, static_cast<int>(block.size()), std::sqrt(square)});
        for (std::size_t k = 0; k < block.size() / 2; ++k)
            block[k] = (block[2 * k] + block[2 * k + 1]) / 2;
        block.resize(block.size() / 2);
    }
    return result;
}

int start_up_cut(std::span<const double> series)
{
    require_finite(series);
    if (series.size() < 4) return 0;
    const std::size_t block_length = (series.size() - 1) / longest_start_up_series + 1;
    const std::vector<double> means = block_means(series, block_length);
    const std::size_t last = means.size() / 2;
    const std::size_t spacing = std::max<std::size_t>(1, last / start_up_candidates);

    std::size_t best = 0;
    double most = 0;
    for (std::size_t cut = 0; cut <= last; cut += spacing) {
        const double count = effective_samples(std::span(means).subspan(cut));
        if (count > most) {
            most = count;
            best = cut;
        }
    }
    return static_cast<int>(best * block_length);
}

}
