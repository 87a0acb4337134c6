// engine/nonaffine_field.h -- how far the particles move beside the affine flow, and over which
// distance they do so together.
//
// V_i = U_i - U_inf(x_i) is the non-affine velocity, the same for all images of a particle. The
// force balance makes sum a_i V_i = 0 (the drag of the solvent is the only force that does not come
// in pairs); here it is made so: w_i = V_i - sum a_j V_j/sum a_j. A uniform velocity that is
// added to all particles therefore changes nothing.
//
//   mean square   <w^2> = sum w_i^2/n [a^2 rate0^2]. If drag relative to the affine flow alone
//                 dissipated the work of the stress, sigma V rate = 6 pi zeta sum a_i w_i^2, so
//                 <w^2>/rate^2 would be proportional to the viscosity sigma/rate (argument of
//                 Ono, Tewari, Langer & Liu, Phys. Rev. E 67, 061503, 2003).
//   correlation   C(r) = <w_i . w_j>_r/<w^2> over all pairs i != j at the distance r; also over
//   those
//                 whose separation is within 30 degrees of an axis. Nearest images, r <= half the
//                 smallest box length.
//   length        where C first falls through 1/e, linear between the bins and from C(0) = 1. Its
//                 error is that of C there over the slope. If C is below 1/e already where the
//                 nearest pairs are, at contact, nothing is known but that it is shorter.
//   integral      of C from C(0) = 1 to its first zero, linear between the bins; sum a_i w_i = 0
//   makes
//                 C negative far away, so the zero moves out with the box.
//
// Tests: plane wave sin(kr)/(kr), white noise, rigid blocks, uniform translation, images, offset +
// Lx.
#pragma once
#include "engine/frame.h"
#include "engine/statistics.h"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace sigmaflow {

/// w [a rate0], [n].
std::vector<Vec3> nonaffine_field(const State& state, const std::vector<Vec3>& nonaffine_velocity);

/// <w^2>.
double mean_square(const std::vector<Vec3>& field);

/// mean(a) mean(b)^power of two series of the same frames; its error is that of the linear part.
/// Errors: input (different lengths), numerics (mean(b) = 0).
Estimate product_of_means(std::span<const double> a, std::span<const double> b, double power);

/// Sums over the pairs of one frame, by distance bin; directions: all, then near x, y, z.
struct FieldCorrelation {
    std::array<std::vector<double>, 4> value;  // C of each bin; 0 without pairs
    std::array<std::vector<double>, 4> pairs;
};

/// Errors: input (bins < 1, largest_distance not in (0, half the smallest box length], no motion).
FieldCorrelation field_correlation(const State& state, const std::vector<Vec3>& field,
                                   double largest_distance, int bins);

/// The mean C of frames with the same bins. A bin without pairs in some frame is left out there.
struct MeanFieldCorrelation {
    std::vector<double> distance;  // bin centres [a]
    std::array<std::vector<Estimate>, 4> value;
    std::array<std::vector<double>, 4> pairs;  // of all frames
};
MeanFieldCorrelation mean_field_correlation(std::span<const FieldCorrelation> frames,
                                            double largest_distance);

struct CorrelationLength {
    double length = 0, standard_error = 0;  // [a]
    bool shorter = false;  // than `length`, the first distance that has pairs in every frame
};
/// None if C does not fall through 1/e. `direction`: 0 all, 1 x, 2 y, 3 z.
std::optional<CorrelationLength> correlation_length(std::span<const FieldCorrelation> frames,
                                                    double largest_distance, int direction);

struct IntegralLength {
    double length = 0, standard_error = 0;  // [a]
    double to = 0;                          // the first zero, or the last bin without one [a]
    bool has_zero = false;
};
/// None without a bin that has pairs in every frame.
std::optional<IntegralLength> integral_length(std::span<const FieldCorrelation> frames,
                                              double largest_distance, int direction);

}
