// engine/ensemble.h -- means over independent runs of one protocol, at each strain.
//
// The standard error is that of the mean over the members, which are independent: the root of
// sum (x - mean)^2/(n (n - 1)). Viscosity is stress over mean rate, never the mean of stress over
// rate: a member that hardly flows would outweigh all others. Its error is that of the ratio of two
// correlated means to first order, sum (s - eta r)^2 over n (n - 1) mean(r)^2.
//
// Tests: normal numbers with the error known; correlated pairs, scatter of the ratio over many
// ensembles.
#pragma once
#include <span>
#include <vector>

namespace sigmaflow {

/// One value for each strain.
struct EnsembleMean {
    std::vector<double> mean, standard_error;  // errors 0 for one member
};

/// [members][strains], all of one length. Errors: input (no member, different lengths), numerics
/// (a mean of the denominator that is 0).
EnsembleMean ensemble_mean(std::span<const std::vector<double>> members);
EnsembleMean ensemble_ratio(std::span<const std::vector<double>> numerator,
                            std::span<const std::vector<double>> denominator);

}
