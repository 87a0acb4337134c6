#include "engine/band_power.h"

#include "engine/random.h"
#include "engine/units.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace sigmaflow {

namespace {

using Eigen::Index;

constexpr int shifts_per_trial = 199;
enum Stream : std::uint32_t { trial_shifts = 2, trial_places = 3, resampling = 4, test_shifts = 5 };

std::complex<double> turn(Index mode, int shift, int slabs)
{
    return std::polar(1.0, -2 * pi * static_cast<double>((mode + 1) * shift) / slabs);
}

/// Every column shifted by its number of slabs.
Amplitudes shifted(const Amplitudes& amplitudes, const Eigen::MatrixXi& shifts, Index trial,
                   int slabs)
{
    Amplitudes result = amplitudes;
    for (Index t = 0; t < result.cols(); ++t)
        for (Index m = 0; m < result.rows(); ++m) result(m, t) *= turn(m, shifts(trial, t), slabs);
    return result;
}

/// Bisection for the contrast at which this many of the trials find the bands.
std::optional<double> smallest_contrast(const UniformitySettings& settings,
                                        const std::function<bool(Index trial, double)>& finds)
{
    const auto enough = [&](double contrast) {
        const double allowed = (1 - settings.power) * settings.trials + 1e-9;
        int missed = 0;
        for (Index trial = 0; trial < settings.trials && missed <= allowed; ++trial)
            missed += !finds(trial, contrast);
        return missed <= allowed;
    };
    double high = settings.largest_contrast, low = 0;
    if (!enough(high)) return std::nullopt;
    // where bands are far too weak, few trials decide
    while (low == 0 && high > 1e-6 * settings.largest_contrast)
        (enough(high / 2) ? high : low) = high / 2;
    while (high > 1.02 * low && low > 0) {
        const double middle = (low + high) / 2;
        (enough(middle) ? high : low) = middle;
    }
    return high;
}

}

std::optional<double> smallest_steady_contrast(const Amplitudes& blocks, const BandShapes& shapes,
                                               const UniformitySettings& settings)
{
    const int slabs = shapes.slabs;
    const int shifts = std::max(shifts_per_trial, static_cast<int>(std::ceil(4 / settings.level)));
    const auto test = random_shifts(shifts, blocks.cols(), slabs, {settings.seed, test_shifts});
    const auto trials =
        random_shifts(settings.trials, blocks.cols(), slabs, {settings.seed, trial_shifts});
    const Eigen::VectorXcd bands = band_amplitudes(shapes.modes, slabs, 0.5, 0);
    return smallest_contrast(settings, [&](Index trial, double contrast) {
        Amplitudes banded = shifted(blocks, trials, trial, slabs);
        banded.colwise() += contrast * bands;
        return steady_band_p_value(banded, shapes, test) <= settings.level / 2;
    });
}

std::optional<double> smallest_moving_contrast(const Amplitudes& amplitudes, int slabs,
                                               const std::vector<double>& expected,
                                               const UniformitySettings& settings)
{
    const Index instants = amplitudes.cols();
    const auto places =
        random_shifts(settings.trials, instants, slabs, {settings.seed, trial_places});
    const auto turns =
        random_shifts(settings.trials, instants, slabs, {settings.seed, trial_shifts});
    const auto chosen = random_shifts(settings.trials, instants, static_cast<int>(instants),
                                      {settings.seed, resampling});
    const Eigen::VectorXcd bands =
        band_amplitudes(static_cast<int>(amplitudes.rows()), slabs, 0.5, 0);
    return smallest_contrast(settings, [&](Index trial, double contrast) {
        Amplitudes banded(amplitudes.rows(), instants);
        for (Index t = 0; t < instants; ++t)
            for (Index m = 0; m < banded.rows(); ++m)
                banded(m, t) = amplitudes(m, chosen(trial, t)) * turn(m, turns(trial, t), slabs) +
                               contrast * bands(m) * turn(m, places(trial, t), slabs);
        return upper_p_value(expected, moving_band_excess(banded)) <= settings.level / 2;
    });
}

}
