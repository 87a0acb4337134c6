#include "engine/random.h"
#include "engine/uniformity.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow {

namespace {

enum Stream : std::uint32_t { noise_shifts = 6, resampling = 7 };
constexpr int draws = 999;

/// Mean of the half of the box that begins with each slab, minus that of the other half.
Eigen::VectorXd half_differences(const std::vector<double>& profile)
{
    const std::size_t slabs = profile.size();
    double total = 0;
    for (double value : profile) total += value;
    Eigen::VectorXd result(static_cast<Eigen::Index>(slabs));
    for (std::size_t from = 0; from < slabs; ++from) {
        double sum = 0;
        for (std::size_t k = 0; k < slabs / 2; ++k) sum += profile[(from + k) % slabs];
        if (slabs % 2 == 1) sum += profile[(from + slabs / 2) % slabs] / 2;
        result(static_cast<Eigen::Index>(from)) =
            (2 * sum - total) / (static_cast<double>(slabs) / 2);
    }
    return result;
}

double largest(const Eigen::VectorXd& differences)
{
    return differences.cwiseAbs().maxCoeff();
}

}

OrderParameter order_parameter(const Field& blocks, const UniformitySettings& settings)
{
    const auto count = static_cast<Eigen::Index>(blocks.size());
    const auto slabs = static_cast<Eigen::Index>(blocks.at(0).size());
    Eigen::MatrixXd differences(slabs, count);
    for (Eigen::Index b = 0; b < count; ++b)
        differences.col(b) = half_differences(blocks[static_cast<std::size_t>(b)]);
    const Eigen::VectorXd measured = differences.rowwise().mean();
    OrderParameter result;
    result.value = largest(measured);

    const auto shifts =
        random_shifts(draws, count, static_cast<int>(slabs), {settings.seed, noise_shifts});
    const auto chosen =
        random_shifts(draws, count, static_cast<int>(count), {settings.seed, resampling});
    std::vector<double> noise, errors;
    for (Eigen::Index r = 0; r < draws; ++r) {
        Eigen::VectorXd shifted = Eigen::VectorXd::Zero(slabs), resampled = shifted;
        for (Eigen::Index b = 0; b < count; ++b) {
            const Eigen::Index by = shifts(r, b);
            shifted.tail(slabs - by) += differences.col(b).head(slabs - by);
            shifted.head(by) += differences.col(b).tail(by);
            resampled += differences.col(chosen(r, b));
        }
        noise.push_back(largest(shifted) / static_cast<double>(count));
        errors.push_back(largest(resampled / static_cast<double>(count) - measured));
    }
    std::sort(noise.begin(), noise.end());
    std::sort(errors.begin(), errors.end());
    for (double value : noise) result.from_noise += value / draws;
    result.p_value = upper_p_value(noise, result.value * (1 - 1e-9));
    // resampling n blocks has the scatter of n - 1
    const double n = static_cast<double>(count), scatter = std::sqrt(n / std::max(1.0, n - 1));
    const auto place = std::lround((1 - settings.level) * (draws - 1));
    const double error = scatter * errors[static_cast<std::size_t>(place)];
    result.lower = std::max(0.0, result.value - error);
    result.upper = result.value + error;
    return result;
}

}
