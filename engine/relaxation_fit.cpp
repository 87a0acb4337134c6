#include "engine/relaxation_fit.h"

#include "engine/error.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <unsupported/Eigen/NonLinearOptimization>
#include <unsupported/Eigen/NumericalDiff>

namespace sigmaflow::relaxation_fit {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

void require(bool good, const std::string& problem)
{
    if (!good) throw Error(ErrorKind::input, "relaxation", problem);
}

Ends ends(const KnownEnds& known, int exponentials)
{
    const int n = exponentials + 1;
    Ends result{VectorXd::Zero(n), MatrixXd::Identity(n, n)};
    if (known.plateau) {
        result.fixed[0] = *known.plateau;
        result.free = result.free.rightCols(n - 1).eval();
    }
    if (known.initial) {  // the last amplitude is what is left
        result.fixed[n - 1] = *known.initial - (known.plateau ? *known.plateau : 0);
        result.free.row(n - 1) = -result.free.topRows(n - 1).colwise().sum();
        result.free = result.free.leftCols(result.free.cols() - 1).eval();
    }
    return result;
}

/// For trial relaxation strains.
struct Projection {
    VectorXd linear;    // plateau, amplitudes
    VectorXd residual;  // over the errors
    MatrixXd basis;     // of the free parameters, over the errors
};

MatrixXd exponentials_of(const Data& data, const VectorXd& logarithms)
{
    MatrixXd basis(data.strain.size(), logarithms.size() + 1);
    basis.col(0).setOnes();
    for (Eigen::Index i = 0; i < logarithms.size(); ++i)
        basis.col(i + 1) = (-data.strain.array() * std::exp(-logarithms[i])).exp();
    return basis;
}

Projection project(const Data& data, const VectorXd& logarithms)
{
    const MatrixXd weighted = data.weight.asDiagonal() * exponentials_of(data, logarithms);
    Projection result;
    const VectorXd target = data.weight.cwiseProduct(data.value) - weighted * data.ends.fixed;
    result.basis = weighted * data.ends.free;
    VectorXd z(result.basis.cols());  // none if both ends of one exponential are known
    if (z.size() > 0) z = result.basis.completeOrthogonalDecomposition().solve(target);
    result.linear = data.ends.fixed + data.ends.free * z;
    result.residual = result.basis * z - target;
    return result;
}

VectorXd clamped(const Data& data, const VectorXd& logarithms)
{
    return logarithms.cwiseMax(std::log(data.shortest)).cwiseMin(std::log(data.longest));
}

struct Residual {
    using Scalar = double;
    using InputType = VectorXd;
    using ValueType = VectorXd;
    using JacobianType = MatrixXd;
    enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };
    const Data* data;
    Eigen::Index inputs_;

    int inputs() const { return static_cast<int>(inputs_); }
    int values() const { return static_cast<int>(data->strain.size()); }
    int operator()(const VectorXd& logarithms, VectorXd& residual) const
    {
        residual = project(*data, clamped(*data, logarithms)).residual;
        return 0;
    }
};

/// Covariance of (logarithms, z); directions that the data leave open get a large finite error.
MatrixXd covariance(const Data& data, const VectorXd& logarithms, const Projection& best)
{
    const Eigen::Index n = logarithms.size(), free = best.basis.cols();
    MatrixXd jacobian(data.strain.size(), n + free);
    const MatrixXd basis = exponentials_of(data, logarithms);
    for (Eigen::Index i = 0; i < n; ++i)
        jacobian.col(i) = data.weight.array() * basis.col(i + 1).array() * best.linear[i + 1] *
                          data.strain.array() * std::exp(-logarithms[i]);
    jacobian.rightCols(free) = best.basis;
    const Eigen::JacobiSVD<MatrixXd> svd(jacobian, Eigen::ComputeThinV);
    const VectorXd singular =
        svd.singularValues().cwiseMax(1e-12 * std::max(svd.singularValues()[0], 1e-280));
    const MatrixXd scaled = svd.matrixV() * singular.cwiseInverse().asDiagonal();
    return scaled * scaled.transpose();
}

void sort_terms(Relaxation& relaxation)
{
    std::sort(relaxation.terms.begin(), relaxation.terms.end(),
              [](const RelaxationTerm& a, const RelaxationTerm& b) {
                  return a.relaxation_strain.mean > b.relaxation_strain.mean;
              });
}

/// Terms, plateau and initial value without errors.
Relaxation unsorted(const VectorXd& logarithms, const Projection& best)
{
    Relaxation result;
    result.plateau.mean = best.linear[0];
    result.initial.mean = best.linear.sum();
    for (Eigen::Index i = 0; i < logarithms.size(); ++i)
        result.terms.push_back({{best.linear[i + 1], 0}, {std::exp(logarithms[i]), 0}});
    return result;
}

}

Data data_of(std::span<const double> strain, std::span<const double> value,
             std::span<const double> error, int exponentials, const KnownEnds& known)
{
    require(exponentials == 1 || exponentials == 2,
            "needs 1 or 2 exponentials, got " + std::to_string(exponentials));
    require(strain.size() == value.size() && strain.size() == error.size(),
            "needs one value and one error for every strain");
    require(strain.size() >= 2 * static_cast<std::size_t>(exponentials) + 2,
            "needs at least " + std::to_string(2 * exponentials + 2) + " strains, got " +
                std::to_string(strain.size()));
    const auto vector = [](std::span<const double> x) {
        return VectorXd(Eigen::Map<const VectorXd>(x.data(), static_cast<Eigen::Index>(x.size())));
    };
    Data data{.strain = vector(strain), .value = vector(value), .weight = {}, .ends = {}};
    const VectorXd errors = vector(error);
    require(data.strain.allFinite() && data.value.allFinite() && errors.allFinite(),
            "has a number that is not finite");
    require(errors.minCoeff() > 0, "needs errors > 0");
    const Eigen::Index last = data.strain.size() - 1;
    const VectorXd spacing = data.strain.tail(last) - data.strain.head(last);
    require(data.strain[0] >= 0 && spacing.minCoeff() > 0, "needs strains >= 0 that rise");
    data.weight = errors.cwiseInverse();
    data.ends = ends(known, exponentials);
    data.shortest = spacing.minCoeff() / 10;
    data.longest = 10 * (data.strain[last] - data.strain[0]);
    return data;
}

VectorXd start(const Data& data, int exponentials)
{
    constexpr int points = 16;
    const double low = std::log(data.shortest * 10), high = std::log(data.longest / 10);
    const auto at = [&](int k) { return low + (high - low) * k / (points - 1); };
    VectorXd best;
    double least = std::numeric_limits<double>::infinity();
    const auto consider = [&](const VectorXd& trial) {
        const double chi2 = project(data, trial).residual.squaredNorm();
        if (!(chi2 < least)) return;
        least = chi2;
        best = trial;
    };
    for (int i = 0; i < points; ++i) {
        if (exponentials == 1) consider(VectorXd::Constant(1, at(i)));
        for (int j = 0; exponentials == 2 && j < i; ++j) consider(Eigen::Vector2d(at(i), at(j)));
    }
    return best;
}

VectorXd minimised(const Data& data, const VectorXd& start)
{
    Eigen::NumericalDiff<Residual, Eigen::Central> residual(Residual{&data, start.size()}, 1e-10);
    Eigen::LevenbergMarquardt<decltype(residual)> search(residual);
    search.parameters.xtol = search.parameters.ftol = 1e-12;
    VectorXd logarithms = start;
    search.minimize(logarithms);
    return clamped(data, logarithms);
}

Relaxation values_at(const Data& data, const VectorXd& logarithms)
{
    Relaxation result = unsorted(logarithms, project(data, logarithms));
    sort_terms(result);
    return result;
}

bool is_resolved(const Data& data, const Relaxation& relaxation)
{
    return std::all_of(relaxation.terms.begin(), relaxation.terms.end(),
                       [&](const RelaxationTerm& term) {
                           const double strain = term.relaxation_strain.mean;
                           return strain > 1.001 * data.shortest && strain < 0.999 * data.longest &&
                                  term.amplitude.standard_error < std::abs(term.amplitude.mean);
                       });
}

Relaxation fit(const Data& data, const VectorXd& logarithms, double correlation_time)
{
    const Projection best = project(data, logarithms);
    Relaxation result = unsorted(logarithms, best);
    const MatrixXd all = covariance(data, logarithms, best);
    const Eigen::Index n = logarithms.size(), free = data.ends.free.cols();
    const MatrixXd linear =
        data.ends.free * all.bottomRightCorner(free, free) * data.ends.free.transpose();
    const auto error = [](double variance) { return std::sqrt(std::max(variance, 0.)); };
    result.plateau.standard_error = error(linear(0, 0));
    result.initial.standard_error = error(linear.sum());
    for (Eigen::Index i = 0; i < n; ++i) {
        RelaxationTerm& term = result.terms[static_cast<std::size_t>(i)];
        term.amplitude.standard_error = error(linear(i + 1, i + 1));
        term.relaxation_strain.standard_error = term.relaxation_strain.mean * error(all(i, i));
    }
    sort_terms(result);
    const double chi2 = best.residual.squaredNorm();
    const auto parameters = static_cast<double>(n + free);
    const double degrees = static_cast<double>(data.strain.size()) - parameters;
    if (degrees > 0) result.chi2_per_degree = chi2 / degrees;
    result.aic = chi2 / (2 * correlation_time) + 2 * parameters;
    result.correlation_time = correlation_time;
    result.resolved = is_resolved(data, result);
    return result;
}

}
