#include "engine/band_search.h"

#include "engine/error.h"
#include "engine/random.h"
#include "engine/units.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>

namespace sigmaflow {

namespace {

using Complex = std::complex<double>;
using Eigen::Index;

constexpr double rounding = 1e-9;  // of statistics that are equal but for the order of their sums

Complex turned(double turns)
{
    return std::polar(1.0, -2 * pi * turns);
}

void check(const Field& field, int modes)
{
    const auto refuse = [](ErrorKind kind, const std::string& problem) {
        throw Error(kind, "band search", problem);
    };
    if (field.empty()) refuse(ErrorKind::input, "at least one instant is needed, got 0");
    const std::size_t slabs = field[0].size();
    if (modes < 1 || slabs < 2 * static_cast<std::size_t>(modes) + 1)
        refuse(ErrorKind::input, std::to_string(modes) + " modes need at least " +
                                     std::to_string(2 * modes + 1) + " slabs, got " +
                                     std::to_string(slabs));
    for (const auto& instant : field) {
        if (instant.size() != slabs)
            refuse(ErrorKind::input, "all instants must have " + std::to_string(slabs) +
                                         " slabs, got " + std::to_string(instant.size()));
        for (double value : instant)
            if (!std::isfinite(value)) refuse(ErrorKind::numerics, "a value is not finite");
    }
}

/// Real and imaginary parts in turns, each divided by its standard deviation if the mean of all
/// blocks has the variance power/blocks: chi2 is the square of the result.
Eigen::VectorXd deviation_weights(const Amplitudes& blocks)
{
    Eigen::VectorXd weights(2 * blocks.rows());
    for (Index m = 0; m < blocks.rows(); ++m) {
        const double power = blocks.row(m).cwiseAbs2().mean();
        const double weight =
            power > 0 ? std::sqrt(2 * static_cast<double>(blocks.cols()) / power) : 0;
        weights(2 * m) = weights(2 * m + 1) = weight;
    }
    return weights;
}

/// Means over the blocks, unshifted in the first column. [2 modes x (1 + shifts)]
Eigen::MatrixXd shifted_means(const Amplitudes& blocks, int slabs, const Eigen::MatrixXi& shifts)
{
    Eigen::MatrixXd means(2 * blocks.rows(), 1 + shifts.rows());
    const double count = static_cast<double>(blocks.cols());
    for (Index m = 0; m < blocks.rows(); ++m) {
        std::vector<Complex> turn(static_cast<std::size_t>(slabs));
        for (int s = 0; s < slabs; ++s)
            turn[static_cast<std::size_t>(s)] = turned(static_cast<double>((m + 1) * s) / slabs);
        const auto store = [&](Index column, Complex sum) {
            means(2 * m, column) = sum.real() / count;
            means(2 * m + 1, column) = sum.imag() / count;
        };
        store(0, blocks.row(m).sum());
        for (Index r = 0; r < shifts.rows(); ++r) {
            Complex sum = 0;
            for (Index b = 0; b < blocks.cols(); ++b)
                sum += blocks(m, b) * turn[static_cast<std::size_t>(shifts(r, b))];
            store(1 + r, sum);
        }
    }
    return means;
}

/// The measured statistic stands first.
double rank_p_value(const Eigen::VectorXd& statistics)
{
    const double least = statistics(0) - rounding * std::abs(statistics(0));
    return static_cast<double>((statistics.array() >= least).count()) /
           static_cast<double>(statistics.size());
}

/// Shapes over their deviations, of length one.
Eigen::MatrixXd unit_shapes(const BandShapes& shapes, const Eigen::VectorXd& weights)
{
    return (shapes.amplitudes * weights.asDiagonal()).rowwise().normalized();
}

/// The likelihood ratio of every column of deviations. One column at a time: a product of matrices
/// would be divided among threads, which are worth nothing here.
Eigen::VectorXd likelihood_ratios(const Eigen::MatrixXd& unit, const Eigen::MatrixXd& deviations)
{
    Eigen::VectorXd ratios(deviations.cols()), overlap(unit.rows());
    for (Index r = 0; r < deviations.cols(); ++r) {
        overlap.noalias() = unit * deviations.col(r);
        ratios(r) = overlap.cwiseAbs2().maxCoeff();
    }
    return ratios;
}

}

Amplitudes mode_amplitudes(const Field& field, int modes)
{
    check(field, modes);
    const auto slabs = static_cast<Index>(field[0].size());
    Eigen::MatrixXcd waves(modes, slabs);
    for (Index m = 0; m < modes; ++m)
        for (Index k = 0; k < slabs; ++k)
            waves(m, k) = turned(static_cast<double>(m + 1) * (static_cast<double>(k) + 0.5) /
                                 static_cast<double>(slabs)) /
                          static_cast<double>(slabs);
    Amplitudes result(modes, static_cast<Index>(field.size()));
    for (std::size_t t = 0; t < field.size(); ++t)
        result.col(static_cast<Index>(t)) =
            waves * Eigen::Map<const Eigen::VectorXd>(field[t].data(), slabs).cast<Complex>();
    return result;
}

Eigen::VectorXcd band_amplitudes(int modes, int slabs, double width, double place)
{
    Eigen::VectorXcd result(modes);
    for (int m = 1; m <= modes; ++m)
        result(m - 1) = turned(m * (place + width / 2)) * std::sin(pi * m * width) /
                        (slabs * std::sin(pi * m / slabs));
    return result;
}

int instants_per_block(const Amplitudes& amplitudes)
{
    const Index instants = amplitudes.cols();
    if (instants < 5) return 1;
    const auto n = static_cast<double>(instants);
    double largest = 0;
    for (Index m = 0; m < amplitudes.rows(); ++m) {
        const Eigen::RowVectorXcd d =
            (amplitudes.row(m).array() - amplitudes.row(m).mean()).matrix();
        const double variance = d.squaredNorm();
        if (!(variance > 0)) continue;
        const double measured = d.head(instants - 1).dot(d.tail(instants - 1)).real() / variance;
        // subtracting the mean lowers it by (1 + 3 r)/n: M. G. Kendall, Biometrika 41, 403, 1954
        largest = std::max(largest, (n * measured + 1) / (n - 3));
    }
    if (largest < 2.5 * n / (n - 3) / std::sqrt(2 * n)) return 1;
    const double r = std::min(largest, 0.99);
    return static_cast<int>(std::min(n, std::ceil(2 * (1 + r) / (1 - r))));
}

Amplitudes block_means(const Amplitudes& amplitudes, int blocks)
{
    Amplitudes result(amplitudes.rows(), blocks);
    for (Index b = 0; b < blocks; ++b) {
        const Index from = b * amplitudes.cols() / blocks;
        const Index to = (b + 1) * amplitudes.cols() / blocks;
        result.col(b) = amplitudes.middleCols(from, to - from).rowwise().mean();
    }
    return result;
}

Eigen::MatrixXi random_shifts(int count, Index blocks, int slabs, RandomNumbers random)
{
    Eigen::MatrixXi shifts(count, blocks);
    std::uint64_t counter = 0;
    for (Index r = 0; r < count; ++r)
        for (Index b = 0; b < blocks; ++b)
            shifts(r, b) = static_cast<int>(slabs * uniform(random.seed, random.stream, counter++));
    return shifts;
}

BandShapes::BandShapes(int modes_, int slabs_) : modes(modes_), slabs(slabs_)
{
    // a multiple of the slabs: translated data have the same likelihood ratio
    const int places = slabs * ((32 + slabs - 1) / slabs);
    for (int sixteenths = 2; sixteenths <= 8; ++sixteenths)
        for (int p = 0; p < places; ++p) {
            width.push_back(sixteenths / 16.0);
            place.push_back(static_cast<double>(p) / places);
        }
    amplitudes.resize(static_cast<Index>(width.size()), 2 * modes);
    for (std::size_t s = 0; s < width.size(); ++s) {
        const Eigen::VectorXcd band = band_amplitudes(modes, slabs, width[s], place[s]);
        for (Index m = 0; m < modes; ++m) {
            amplitudes(static_cast<Index>(s), 2 * m) = band(m).real();
            amplitudes(static_cast<Index>(s), 2 * m + 1) = band(m).imag();
        }
    }
}

double steady_band_p_value(const Amplitudes& blocks, const BandShapes& shapes,
                           const Eigen::MatrixXi& shifts)
{
    const Eigen::VectorXd weights = deviation_weights(blocks);
    const Eigen::MatrixXd deviations =
        weights.asDiagonal() * shifted_means(blocks, shapes.slabs, shifts);
    return rank_p_value(likelihood_ratios(unit_shapes(shapes, weights), deviations));
}

SteadyBands search_steady_bands(const Amplitudes& blocks, const BandShapes& shapes,
                                const Eigen::MatrixXi& shifts)
{
    const Eigen::VectorXd weights = deviation_weights(blocks);
    const Eigen::MatrixXd deviations =
        weights.asDiagonal() * shifted_means(blocks, shapes.slabs, shifts);
    SteadyBands result;
    const Eigen::VectorXd chi2 = deviations.colwise().squaredNorm().transpose();
    result.chi2 = chi2(0);
    result.chi2_p_value = rank_p_value(chi2);
    for (Index m = 0; m < blocks.rows(); ++m)
        result.mode_p_value.push_back(
            rank_p_value(deviations.middleRows(2 * m, 2).colwise().squaredNorm().transpose()));

    const Eigen::MatrixXd unit = unit_shapes(shapes, weights);
    const Eigen::VectorXd ratio = likelihood_ratios(unit, deviations);
    result.likelihood_ratio = ratio(0);
    result.p_value = rank_p_value(ratio);

    Index best = 0;
    const Eigen::VectorXd overlap = unit * deviations.col(0);
    overlap.cwiseAbs2().maxCoeff(&best);
    const double length = (shapes.amplitudes.row(best) * weights.asDiagonal()).norm();
    const double contrast = length > 0 ? overlap(best) / length : 0;
    const auto s = static_cast<std::size_t>(best);
    const bool high = contrast > 0;
    result.contrast = std::abs(contrast);
    result.fraction = high ? shapes.width[s] : 1 - shapes.width[s];
    const double middle = shapes.place[s] + shapes.width[s] / 2 + (high ? 0 : 0.5);
    result.place = middle - std::floor(middle);
    return result;
}

}
