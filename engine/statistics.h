// engine/statistics.h -- mean and standard error of a correlated time series, and its start-up.
//
// estimate_mean takes samples at equal spacing. With rho(t) the normalised autocorrelation,
//   tau = 1/2 + sum_{t >= 1} rho(t)       integrated correlation time [sample spacings]
//   standard error^2 = 2 tau variance / n
// and the sum ends at the smallest window w >= 5 tau(w) (self-consistent window: A. D. Sokal, in
// Functional Integration, 131-192, 1997; Madras & Sokal, J. Stat. Phys. 50, 109, 1988).
// The bias from subtracting the sample mean is removed to first order (Wolff, Comput. Phys. Commun.
// 156, 143, 2004). Cross-check: blocking (Flyvbjerg & Petersen, J. Chem. Phys. 91, 461,
// 1989) at the block length B of least total error, B^3 > 2 n (2 tau)^2 (Lee et al., Phys. Rev. E
// 83, 066706, 2011). standard_error is the larger of the two.
//
// Tests: AR(1) processes of known tau, coverage of the truth by one standard error.
#pragma once
#include <span>
#include <vector>

namespace sigmaflow {

struct Estimate {
    double mean = 0;
    double standard_error = 0;      // of the mean: max(autocorrelation_error, blocking_error)
    double correlation_time = 0.5;  // tau [sample spacings] >= 1/2; 1/2 for independent samples
    double effective_samples = 0;   // used / (2 tau) [-]; 0 for no sample, 1 if nothing fluctuates
    double autocorrelation_error = 0;
    double blocking_error = 0;
    int used = 0;           // samples
    bool reliable = false;  // the error is good to about one third: see estimate_mean
};

/// Always finite for finite input. `reliable` is false, and the error a guess (usually too small),
/// for fewer than 2 samples (error 0), a series that never changes (error 0), fewer than 10
/// effective samples, or a window or a block length that did not converge within the series. Throws
/// Error(numerics) for a sample that is not finite.
Estimate estimate_mean(std::span<const double> series);

/// rho(t) for t = 0 ... lags (fewer for a short series): the autocovariance over the variance, mean
/// of the series subtracted, bias not removed. 1, 0, 0 ... for a series that never changes. Throws
/// Error(numerics) for a sample that is not finite.
std::vector<double> autocorrelation(std::span<const double> series, int lags);

/// Standard error of the mean from means over blocks of 1, 2, 4 ... samples, as if these were
/// independent: it rises to a plateau where they are. Down to two blocks; the last errors are known
/// to about 1/sqrt(2 (blocks - 1)) of themselves.
struct BlockError {
    int length = 1;  // [samples]
    int blocks = 0;
    double error = 0;  // [unit of the samples]
};
std::vector<BlockError> block_errors(std::span<const double> series);

/// Index of the first sample after the start-up: the cut that leaves the largest number of
/// effective samples (Chodera, J. Chem. Theory Comput. 12, 1799, 2016). Candidates are 50 equally
/// spaced cuts in the first half of the series; it never cuts more than half, so a result close to
/// size()/2 means that the series is still in its start-up. 0 for fewer than 4 samples. Throws
/// Error(numerics) for a sample that is not finite.
int start_up_cut(std::span<const double> series);

}
