#include "engine/band_search.h"
#include "engine/random.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow {

namespace {

using Eigen::Index;

/// Value at m = 1 over that of the straight line through the others, against ln m.
double excess(const std::vector<double>& log_power)
{
    const auto others = static_cast<double>(log_power.size() - 1);
    double x = 0, y = 0, xx = 0, xy = 0;
    for (std::size_t k = 1; k < log_power.size(); ++k) {
        const double log_mode = std::log(static_cast<double>(k + 1));
        x += log_mode;
        y += log_power[k];
        xx += log_mode * log_mode;
        xy += log_mode * log_power[k];
    }
    const double slope = (others * xy - x * y) / (others * xx - x * x);
    return log_power[0] - (y - slope * x) / others;
}

}

double moving_band_excess(const Amplitudes& amplitudes)
{
    std::vector<double> log_power;
    for (Index m = 0; m < amplitudes.rows(); ++m) {
        const std::complex<double> mean = amplitudes.row(m).mean();
        log_power.push_back(std::log((amplitudes.row(m).array() - mean).abs2().mean()));
    }
    return excess(log_power);
}

std::vector<double> excess_without_bands(int modes, int degrees, int count, RandomNumbers random)
{
    std::vector<double> values;
    std::uint64_t counter = 0;
    std::vector<double> log_power(static_cast<std::size_t>(modes));
    for (int r = 0; r < count; ++r) {
        for (double& power : log_power) {
            double sum = 0;  // |Gaussian amplitude|^2 is exponential
            for (int k = 0; k < degrees; ++k)
                sum -= std::log1p(-uniform(random.seed, random.stream, counter++));
            power = std::log(sum);
        }
        values.push_back(excess(log_power));
    }
    std::sort(values.begin(), values.end());
    return values;
}

double upper_p_value(const std::vector<double>& ascending, double measured)
{
    const auto above =
        ascending.end() - std::lower_bound(ascending.begin(), ascending.end(), measured);
    return static_cast<double>(above + 1) / static_cast<double>(ascending.size() + 1);
}

}
