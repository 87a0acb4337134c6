#include "engine/velocity_profile.h"

#include "engine/error.h"
#include "engine/slabs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace sigmaflow {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct MeanAndError {
    double mean = nan, error = nan;
};

/// Of independent values; those that are NaN do not count.
MeanAndError mean_and_error(const std::vector<double>& values)
{
    double sum = 0, squares = 0;
    int count = 0;
    for (const double value : values)
        if (!std::isnan(value)) {
            sum += value;
            ++count;
        }
    if (count == 0) return {};
    const double mean = sum / count;
    for (const double value : values)
        if (!std::isnan(value)) squares += (value - mean) * (value - mean);
    return {mean, count < 2 ? nan : std::sqrt(squares / (count - 1) / count)};
}

/// Least-squares slope over the slabs that are not empty; NaN for fewer than two.
double fitted_slope(const VelocityProfile& profile)
{
    double count = 0, sum_y = 0, sum_u = 0;
    for (std::size_t k = 0; k < profile.y.size(); ++k)
        if (!std::isnan(profile.u[k])) {
            count += 1;
            sum_y += profile.y[k];
            sum_u += profile.u[k];
        }
    double yy = 0, yu = 0;
    for (std::size_t k = 0; k < profile.y.size(); ++k)
        if (!std::isnan(profile.u[k])) {
            const double dy = profile.y[k] - sum_y / count;
            yy += dy * dy;
            yu += dy * (profile.u[k] - sum_u / count);
        }
    return yy > 0 ? yu / yy : nan;
}

Uniformity uniformity(const MeanProfile& mean, const std::vector<VelocityProfile>& profiles)
{
    Uniformity result;
    double squares = 0, chi2 = 0;
    int slabs = 0;
    for (std::size_t k = 0; k < mean.y.size(); ++k) {
        if (std::isnan(mean.u[k])) continue;
        const double deviation = mean.u[k] - mean.y[k];
        const double error = mean.standard_error[k];
        result.largest_deviation = std::max(result.largest_deviation, std::abs(deviation));
        squares += deviation * deviation;
        chi2 += deviation == 0 ? 0 * error : std::pow(deviation / error, 2);
        ++slabs;
    }
    result.rms_deviation = std::sqrt(squares / slabs);
    result.chi2_per_bin = chi2 / slabs;

    std::vector<double> slopes(profiles.size());
    std::transform(profiles.begin(), profiles.end(), slopes.begin(), fitted_slope);
    const MeanAndError slope = mean_and_error(slopes);
    result.slope = slope.mean;
    result.slope_error = slope.error;
    return result;
}

}

VelocityProfile velocity_profile(const State& state, const std::vector<Vec3>& velocity,
                                 double shear_rate, int bins)
{
    if (bins < 1)
        throw Error(ErrorKind::input, "velocity_profile",
                    "bins must be at least 1, got " + std::to_string(bins));
    if (!std::isfinite(shear_rate) || shear_rate == 0)
        throw Error(
            ErrorKind::numerics, "velocity_profile",
            "the shear rate must be finite and not zero, got " + std::to_string(shear_rate));

    const double height = state.box.length.y();
    const double thickness = height / bins;
    std::vector<double> volume(static_cast<std::size_t>(bins)), flux(volume.size());
    VelocityProfile profile;
    profile.count.resize(volume.size());
    for (std::size_t i = 0; i < state.radius.size(); ++i) {
        const double y = state.position[i].y(), radius = state.radius[i];
        const double nonaffine = velocity[i].x() - shear_rate * y;
        for_each_slab(y, radius, height, bins, [&](int slab, double weight) {
            const auto k = static_cast<std::size_t>(slab);
            volume[k] += weight;
            flux[k] += weight * nonaffine;
        });
        ++profile.count[static_cast<std::size_t>(folded_slab(std::floor(y / thickness), bins))];
    }

    for (int k = 0; k < bins; ++k) {
        const auto slab = static_cast<std::size_t>(k);
        const double y = (k + 0.5) / bins;
        const double deviation = flux[slab] / volume[slab] / (shear_rate * height);
        profile.y.push_back(y);
        profile.u.push_back(volume[slab] > 0 ? y + deviation : nan);
        profile.volume_fraction.push_back(volume[slab] * bins / state.box.volume());
    }
    return profile;
}

MeanProfile mean_profile(const std::vector<VelocityProfile>& profiles)
{
    if (profiles.empty())
        throw Error(ErrorKind::input, "mean_profile", "at least one profile is needed, got 0");
    MeanProfile result;
    result.y = profiles.front().y;
    result.profiles = static_cast<int>(profiles.size());
    for (const VelocityProfile& profile : profiles)
        if (profile.y.size() != result.y.size())
            throw Error(ErrorKind::input, "mean_profile",
                        "all profiles must have " + std::to_string(result.y.size()) +
                            " slabs, got " + std::to_string(profile.y.size()));

    std::vector<double> values(profiles.size()), fractions(profiles.size());
    for (std::size_t k = 0; k < result.y.size(); ++k) {
        for (std::size_t p = 0; p < profiles.size(); ++p) {
            values[p] = profiles[p].u[k];
            fractions[p] = profiles[p].volume_fraction[k];
        }
        const MeanAndError slab = mean_and_error(values);
        result.u.push_back(slab.mean);
        result.standard_error.push_back(slab.error);
        result.volume_fraction.push_back(mean_and_error(fractions).mean);
    }
    result.uniformity = uniformity(result, profiles);
    return result;
}

}
