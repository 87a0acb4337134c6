#include "engine/ensemble.h"

#include "engine/error.h"

#include <cmath>

namespace sigmaflow {

namespace {

void require_equal_lengths(std::span<const std::vector<double>> members)
{
    if (members.empty()) throw Error(ErrorKind::input, "ensemble", "has no members");
    for (const std::vector<double>& member : members)
        if (member.size() != members.front().size())
            throw Error(ErrorKind::input, "ensemble", "has members of different lengths");
}

double error_of_mean(double sum_of_squares, std::size_t members)
{
    const double n = static_cast<double>(members);
    return members > 1 ? std::sqrt(sum_of_squares / (n * (n - 1))) : 0;
}

}

EnsembleMean ensemble_mean(std::span<const std::vector<double>> members)
{
    require_equal_lengths(members);
    EnsembleMean result;
    for (std::size_t k = 0; k < members.front().size(); ++k) {
        double mean = 0, squares = 0;
        for (const std::vector<double>& member : members) mean += member[k];
        mean /= static_cast<double>(members.size());
        for (const std::vector<double>& member : members)
            squares += (member[k] - mean) * (member[k] - mean);
        result.mean.push_back(mean);
        result.standard_error.push_back(error_of_mean(squares, members.size()));
    }
    return result;
}

EnsembleMean ensemble_ratio(std::span<const std::vector<double>> numerator,
                            std::span<const std::vector<double>> denominator)
{
    const EnsembleMean above = ensemble_mean(numerator), below = ensemble_mean(denominator);
    if (numerator.size() != denominator.size() || above.mean.size() != below.mean.size())
        throw Error(ErrorKind::input, "ensemble", "has members of different lengths");
    EnsembleMean result;
    for (std::size_t k = 0; k < above.mean.size(); ++k) {
        if (below.mean[k] == 0)
            throw Error(ErrorKind::numerics, "ensemble", "the mean of the denominator is 0");
        const double ratio = above.mean[k] / below.mean[k];
        double squares = 0;
        for (std::size_t i = 0; i < numerator.size(); ++i) {
            const double deviation = numerator[i][k] - ratio * denominator[i][k];
            squares += deviation * deviation;
        }
        result.mean.push_back(ratio);
        result.standard_error.push_back(error_of_mean(squares, numerator.size()) /
                                        std::abs(below.mean[k]));
    }
    return result;
}

}
