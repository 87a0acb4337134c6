// engine/histogram.h -- probability density of values that come in frames of a run.
//
// Every frame gives a density of its own, count_k/(values of the frame times width); mean and
// standard error of each bin come from the series of the frames (engine/statistics.h), so that
// values which are correlated within a frame do not make the errors too small. Values outside
// [from, to) count in the normalisation: the integral over the bins is 1 - below - above. Frames
// without values do not count.
//
// Tests: exponential and normal densities within the errors, normalisation, values outside.
#pragma once
#include <span>
#include <vector>

namespace sigmaflow {

struct Histogram {
    double from = 0, width = 1;                   // of the bins
    std::vector<double> density, standard_error;  // of each bin [1/unit of the values]
    double below = 0, above = 0;                  // shares of the values outside the bins [-]
    int frames = 0;                               // with values

    double centre(std::size_t bin) const { return from + (static_cast<double>(bin) + 0.5) * width; }
};

/// Errors: input (no bins, empty range), numerics (a value that is not finite).
Histogram histogram(std::span<const std::vector<double>> frames, double from, double to, int bins);

}
