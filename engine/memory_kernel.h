// engine/memory_kernel.h -- how the microstructure remembers the stress, from measured responses.
//
// Relaxation: the answer to a step in stress as a function of the strain x since the step,
//
//   value(x) = plateau + sum_i amplitude_i exp(-x/relaxation_strain_i).
//
// The relaxation strains are found by Levenberg-Marquardt on their logarithms, amplitudes and
// plateau by linear least squares for each trial (variable projection: Golub & Pereyra, SIAM J.
// Numer. Anal. 10, 413, 1973), from the best of a grid of starts. Errors follow from the inverse of
// J^T J with the given errors, or from a bootstrap over the members of an ensemble (Efron &
// Tibshirani, An Introduction to the Bootstrap, 1993): half the width of the central 68.3 % of the
// refitted values. Prefer the latter: the values of one ensemble at different strains are
// correlated.
//
// Memory kernel (Mari, Seto, Morris & Denn, Phys. Rev. E 91, 052302, 2015, Eq. (deltaf_eq)): an
// observable f of the microstructure has the steady value f*(stress), and after any history
//
//   f(x) = w_0 f*(stress(x)) + int dx' K(x - x') f*(stress(x')),  K(x) = sum_i w_i c_i exp(-c_i x),
//   w_0 + sum_i w_i = 1,  c_i = 1/relaxation_strain_i,
//
// so that after a step f = f_plateau - (f_plateau - f_before) sum_i w_i exp(-c_i x). w_0 is what
// follows at once; it is negative where f first jumps the other way.
//
// Tests: exact sums of exponentials, the published misra1a and a noisy ensemble of known
// parameters (coverage of the errors), kernels of responses that were computed from kernels.
#pragma once
#include "engine/value.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace sigmaflow {

struct RelaxationTerm {
    Value amplitude;          // [unit of the values]
    Value relaxation_strain;  // > 0 [-]
};

struct Relaxation {
    std::vector<RelaxationTerm> terms;  // from the slowest to the fastest
    Value plateau;                      // [unit of the values]
    Value initial;                      // plateau + sum of the amplitudes
    double chi2_per_degree = 0;         // with the given errors, samples as if independent
    double aic = 0;                     // chi2/(2 tau) + 2 parameters; the smallest one is best
    double correlation_time = 0.5;      // tau [samples], 1/2 for independent samples
    /// False if a relaxation strain ran to the limit of what the strains can resolve (a tenth of
    /// the smallest spacing, ten times the range), or an amplitude is smaller than its error.
    bool resolved = false;

    double at(double strain) const;
};

/// What is known about a response before it is fitted.
struct KnownEnds {
    std::optional<double> initial;  // at strain 0
    std::optional<double> plateau;
};

/// Fits 1 or 2 `exponentials`. Strains since the step, rising, at least 2 exponentials + 2 of them;
/// errors > 0. Errors: input.
Relaxation fit_relaxation(std::span<const double> strain, std::span<const double> value,
                          std::span<const double> error, int exponentials);
Relaxation fit_relaxation(std::span<const double> strain, std::span<const double> value,
                          std::span<const double> error, int exponentials, const KnownEnds& known);

/// Fits the mean of the members, each with a value at every strain, weighted by the standard errors
/// of the mean. aic counts only independent samples: tau is the mean integrated correlation time of
/// the members' deviations from the mean. Needs 3 members and 10 resamples. Errors: input.
Relaxation fit_relaxation_of_members(std::span<const double> strain,
                                     const std::vector<std::vector<double>>& members,
                                     int exponentials, int resamples, std::uint64_t seed);

/// That with the smaller aic; two exponentials only if they are resolved.
const Relaxation& better_of(const Relaxation& one, const Relaxation& two);

struct MemoryTerm {
    Value weight;  // w_i [-]
    Value c;       // one over the relaxation strain, > 0 [-]
};

struct MemoryKernel {
    std::vector<MemoryTerm> terms;
    double instantaneous = 0;  // w_0; all weights add to 1
};

/// One exponential with the relaxation strain 1/c and no instantaneous part: the paper's kernel.
MemoryKernel exponential_kernel(Value c);

/// Errors: input (no term, c <= 0, weights that are not finite or do not add to 1).
void check(const MemoryKernel& kernel);

/// K(strain) without the instantaneous part, strain >= 0.
double density(const MemoryKernel& kernel, double strain);

/// Of the response of an observable of the microstructure that was `before` ahead of the step. Use
/// the contact number for the paper's f: it cannot jump. Use the viscosity for small steps only:
/// stress = eta_hydrodynamic rate + what contacts carry, so that a large step lets the viscosity
/// fall at once and its way back looks slower than that of the contact stress. Errors: input (the
/// plateau is `before`).
MemoryKernel kernel_of(const Relaxation& response, double before);

/// Of the response of the shear rate to a step from `stress` to `stress + step`, with rate and
/// viscosity ahead of the step: rate - before = step (slope + (g/viscosity) sum_i w_i exp(-c_i x)),
/// g = 1 - viscosity slope (see stability.h). The rate is linear in the contact stress, so this
/// holds for large steps too, and w_0 contains the hydrodynamic answer. Errors: input (g = 0,
/// step = 0, before <= 0).
MemoryKernel kernel_of_rate(const Relaxation& rate_response, double before, double stress,
                            double step);

}
