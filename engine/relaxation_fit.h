// engine/relaxation_fit.h -- least squares of exponentials to one response, and the parts of it
// that a bootstrap repeats. The formulas stand in engine/memory_kernel.h.
#pragma once
#include "engine/memory_kernel.h"

#include <Eigen/Core>

namespace sigmaflow::relaxation_fit {

/// (plateau, amplitudes) = fixed + free z, so that known ends need no case of their own.
struct Ends {
    Eigen::VectorXd fixed;
    Eigen::MatrixXd free;
};

struct Data {
    Eigen::VectorXd strain, value, weight;  // weight: one over the error
    Ends ends;
    double shortest = 0, longest = 0;  // relaxation strains that can be resolved
};

/// Errors: input (see fit_relaxation).
Data data_of(std::span<const double> strain, std::span<const double> value,
             std::span<const double> error, int exponentials, const KnownEnds& known);

/// The logarithms of the best relaxation strains of a grid.
Eigen::VectorXd start(const Data& data, int exponentials);

/// Those of least squares.
Eigen::VectorXd minimised(const Data& data, const Eigen::VectorXd& start);

/// Terms, plateau and initial value without errors.
Relaxation values_at(const Data& data, const Eigen::VectorXd& logarithms);

/// With errors from the weights.
Relaxation fit(const Data& data, const Eigen::VectorXd& logarithms, double correlation_time);

bool is_resolved(const Data& data, const Relaxation& relaxation);

}
