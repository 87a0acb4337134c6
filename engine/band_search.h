// engine/band_search.h -- does a field on slabs of a periodic box have steady or moving bands?
//
// A field f_k(t), k < K slabs, at many instants, as Fourier amplitudes of the wave numbers m:
//   A_m(t) = (1/K) sum_k f_k(t) exp(-2 pi i m (k + 1/2)/K),  m = 1, 2, ...
// Uniform flow in a periodic box looks the same after any translation. So the amplitudes of
// different m are uncorrelated, the covariance of the slabs is that of the powers P_m = <|A_m|^2>,
// and turning the amplitudes of independent instants by random whole slabs s, A_m ->
// A_m exp(-2 pi i m s/K), gives data that are as likely: the share of such data whose statistic is
// at least the measured one is an exact p-value for any number of instants and any distribution (a
// randomisation test: E. J. G. Pitman, J. R. Stat. Soc. Suppl. 4, 119, 1937).
//
// Steady bands, from the means <A_m> of n independent instants:
//   chi2             2 n sum_m |<A_m>|^2/P_m, the distance from uniform with the slabs' covariance
//   likelihood ratio how much of chi2 two bands explain: contrast B (their difference), fraction w
//                    and place p free, <A_m> = B exp(-2 pi i m (p + w/2)) sin(pi m w)/(K sin(pi
//                    m/K))
// Moving bands leave no mean, but fluctuations of mode 1:
//   excess           P'_1 over the value that a power law through P'_2 .. P'_M has at m = 1, with
//                    P'_m = <|A_m - <A_m>|^2>. Without bands each P'_m is a chi^2 variable
//                    (Gaussian amplitudes), and the distribution of the excess does not depend on
//                    the law.
// Why a power law is safe: without inertia the stress of a plane y = const changes by the drag
// alone. A viscosity eta and random stresses of short range s give local rates of power <s^2>
// (k^2/(k^2 + 1/l^2))^2/eta^2, l^2 = eta/drag: white for l k >> 1, falling for k -> 0; the size of
// the particles makes it fall at large k, too. Such a curve lies below the straight line (in
// logarithms) through its values at larger m, so that the test has fewer false alarms than it says.
// Tests: false alarms at the rate that the p-values promise, bands that were put in, translations.
#pragma once
#include <Eigen/Dense>

#include <cstdint>
#include <vector>

namespace sigmaflow {

/// [instants][slabs]
using Field = std::vector<std::vector<double>>;
/// [modes x instants]
using Amplitudes = Eigen::MatrixXcd;

/// Errors: input (no instant, different numbers of slabs, fewer than 2 modes + 1 slabs), numerics
/// (what is not finite).
Amplitudes mode_amplitudes(const Field& field, int modes);

/// Amplitudes of a field of contrast 1 with the high band in [place, place + width) of the box.
Eigen::VectorXcd band_amplitudes(int modes, int slabs, double width, double place);

/// How many successive instants make up a block that is independent of the next one: 1 if the
/// correlation r of neighbours (of the mode with the largest) is below 2.5 of its errors, otherwise
/// 2 (1 + r)/(1 - r), twice the number of correlated samples of an exponential memory. Weak
/// correlations, r < 1.8/sqrt(instants), are not seen.
int instants_per_block(const Amplitudes& amplitudes);

/// Means of successive instants in `blocks` groups of about equal size.
Amplitudes block_means(const Amplitudes& amplitudes, int blocks);

struct RandomNumbers {
    std::uint64_t seed = 1;
    std::uint32_t stream = 0;
};

/// A whole number of slabs for each of `count` shifts and each block, in [0, slabs).
Eigen::MatrixXi random_shifts(int count, Eigen::Index blocks, int slabs, RandomNumbers random);

/// All bands that are tried: widths of 1/8 to 1/2 in steps of 1/16, at least 32 places.
struct BandShapes {
    BandShapes(int modes, int slabs);

    int modes, slabs;
    std::vector<double> width, place;
    Eigen::MatrixXd amplitudes;  // [shapes x 2 modes]: real and imaginary parts in turns
};

struct SteadyBands {
    double chi2 = 0, chi2_p_value = 1;
    double likelihood_ratio = 0, p_value = 1;
    double contrast = 0;             // high minus low, of the best fit, >= 0
    double fraction = 0, place = 0;  // of the box: share and middle of the high band
    std::vector<double> mode_p_value;
};

/// The blocks are taken as independent; two of them or more. [shifts x blocks] from random_shifts.
SteadyBands search_steady_bands(const Amplitudes& blocks, const BandShapes& shapes,
                                const Eigen::MatrixXi& shifts);

/// The p-value of the likelihood ratio alone.
double steady_band_p_value(const Amplitudes& blocks, const BandShapes& shapes,
                           const Eigen::MatrixXi& shifts);

/// ln of the excess of mode 1. Three modes and two instants or more.
double moving_band_excess(const Amplitudes& amplitudes);

/// `count` values of it without bands, ascending; `degrees` = independent instants - 1.
std::vector<double> excess_without_bands(int modes, int degrees, int count, RandomNumbers random);

/// Share of random values that are at least the measured one, which counts as one of them.
double upper_p_value(const std::vector<double>& ascending, double measured);

}
