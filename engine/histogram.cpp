#include "engine/histogram.h"

#include "engine/error.h"
#include "engine/statistics.h"

#include <cmath>
#include <string>

namespace sigmaflow {

Histogram histogram(std::span<const std::vector<double>> frames, double from, double to, int bins)
{
    if (bins < 1 || !(from < to) || !std::isfinite(to - from))
        throw Error(ErrorKind::input, "histogram",
                    "needs at least one bin and a range, got " + std::to_string(bins) +
                        " bins from " + std::to_string(from) + " to " + std::to_string(to));
    Histogram result;
    result.from = from;
    result.width = (to - from) / bins;
    std::vector<std::vector<double>> shares(static_cast<std::size_t>(bins));
    double below = 0, above = 0;
    for (const std::vector<double>& values : frames) {
        if (values.empty()) continue;
        ++result.frames;
        const double one = 1 / static_cast<double>(values.size());
        for (auto& bin : shares) bin.push_back(0);
        for (const double value : values) {
            if (!std::isfinite(value))
                throw Error(ErrorKind::numerics, "histogram",
                            "values must be finite, got " + std::to_string(value));
            const double bin = std::floor((value - from) / result.width);
            if (bin < 0)
                below += one;
            else if (bin >= bins)
                above += one;
            else
                shares[static_cast<std::size_t>(bin)].back() += one;
        }
    }
    for (const auto& bin : shares) {
        const Estimate share = estimate_mean(bin);
        result.density.push_back(share.mean / result.width);
        result.standard_error.push_back(share.standard_error / result.width);
    }
    if (result.frames > 0) {
        result.below = below / result.frames;
        result.above = above / result.frames;
    }
    return result;
}

}
