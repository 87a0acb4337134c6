// engine/uniformity.h -- is a field uniform across the box, and how small a band would have been
// seen?
//
// The field, e.g. the local shear rate over the mean one (slab_profiles.h), is given on K slabs at
// many instants; contrasts are differences high minus low in its unit. Correlated instants are
// first joined to independent blocks (instants_per_block). Then:
//   steady, moving     the two searches of band_search.h; each is decided at half the level, so
//   that
//                      uniform flow is called banded with a probability of at most `level`
//   order parameter    B, the largest difference of the means over one half of the box and the
//   other
//                      one, of the mean profile. For two equal bands it is their contrast; noise
//                      alone makes it positive, by how much is known from the same random shifts.
//                      It cannot be wrong by more than the worst of these differences, whose
//                      quantile in resampled blocks (bootstrap) is the half-width of its interval
//   smallest contrast  of two equal bands, put into the measured field (its blocks shifted by
//   random
//                      slabs, so that steady bands it may have are gone), that the search finds in
//                      95 % of the trials; steady ones at rest, moving ones somewhere else at every
//                      instant, in resampled instants
// Tests: false alarms, bands that were put in, coverage of the interval, the smallest contrast
// against the share of new data in which it is found, translation by whole slabs.
#pragma once
#include "engine/band_search.h"

#include <optional>
#include <string_view>

namespace sigmaflow {

struct UniformitySettings {
    double level = 0.05;          // probability of calling uniform flow banded, (0, 0.5]
    double power = 0.95;          // share of bands of the smallest contrast that are found, (0, 1)
    int modes = 5;                // wave numbers 1 .. modes, >= 3
    double largest_contrast = 2;  // that is put in; 2: the low band of a positive field is at zero
    int shifts = 1999, trials = 200;
    std::uint64_t seed = 1;
};

struct OrderParameter {
    double value = 0;
    double lower = 0, upper = 0;  // interval of confidence 1 - level or more
    double from_noise = 0;        // mean without bands
    double p_value = 1;
};

/// One wave number: the mean of the amplitudes A_m and their scatter.
struct Mode {
    int wave_number = 1;
    double amplitude = 0,
           phase = 0;           // |<A_m>|, and a place of its maximum over the box, in [0, 1/m)
    double standard_error = 0;  // root of <|A_m - <A_m>|^2>/(independent instants)
    double fluctuation = 0;     // <|A_m - <A_m>|^2>
    double p_value = 1;
};

struct MovingBands {
    double excess = 1;  // P'_1 over its expected value
    double p_value = 1;
};

enum class BandVerdict { uniform, bands, undecided };
std::string_view verdict_name(BandVerdict verdict);

struct UniformityTest {
    BandVerdict verdict = BandVerdict::undecided;
    // Of bands at rest alone: moving ones are judged by a power law, which is known to be safe for
    // the local shear rate only (band_search.h). The drag alone gives the stress of planes y =
    // const strong fluctuations of mode 1.
    BandVerdict at_rest = BandVerdict::undecided;
    int instants = 0, blocks = 0;  // measured and independent
    // none of the rest with fewer than `fewest_blocks` blocks
    SteadyBands steady;
    MovingBands moving;
    OrderParameter order;
    std::vector<Mode> modes;
    bool has_steady = false, has_moving = false;             // bands at half the level
    std::optional<double> smallest_steady, smallest_moving;  // none: above the largest contrast
};

inline constexpr int fewest_blocks = 4;

/// `uniform` asks that bands of some contrast up to the largest one would have been seen. Errors:
/// those of mode_amplitudes, and input for settings out of range.
UniformityTest test_uniformity(const Field& field, const UniformitySettings& settings);

/// B of the mean of independent blocks with its interval.
OrderParameter order_parameter(const Field& blocks, const UniformitySettings& settings);

/// Mean over the instants.
std::vector<double> mean_over_instants(const Field& field);

}
