#include "engine/exponents.h"

#include "engine/error.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

namespace sigmaflow {

std::array<std::complex<double>, 2> exponents_of(std::span<const double> series, double spacing)
{
    if (series.size() < 4 || !(spacing > 0))
        throw Error(ErrorKind::input, "exponents", "needs 4 values at equal spacing");
    const auto rows = static_cast<Eigen::Index>(series.size()) - 2;
    // a series that grows is divided by its size, or its end would outweigh its beginning
    Eigen::MatrixX2d known(rows, 2);
    Eigen::VectorXd next(rows);
    for (Eigen::Index k = 0; k < rows; ++k) {
        const double* at = series.data() + k;
        const double largest = std::max({std::abs(at[0]), std::abs(at[1]), std::abs(at[2])});
        if (!(largest > 0) || !std::isfinite(largest))
            throw Error(ErrorKind::numerics, "exponents", "the series is 0 or not finite");
        known.row(k) << at[1] / largest, at[0] / largest;
        next[k] = at[2] / largest;
    }
    const Eigen::Vector2d p = known.colPivHouseholderQr().solve(next);
    const std::complex<double> root = std::sqrt(std::complex<double>(p[0] * p[0] / 4 + p[1]));
    std::array<std::complex<double>, 2> result{std::log(p[0] / 2 + root) / spacing,
                                               std::log(p[0] / 2 - root) / spacing};
    if (result[0].real() < result[1].real()) std::swap(result[0], result[1]);
    return result;
}

}
