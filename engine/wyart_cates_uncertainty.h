// engine/wyart_cates_uncertainty.h -- how well the parameters of wyart_cates_fit.h are known.
//
// Three answers to three questions:
//   bootstrap    how far would other measurements of the same errors and scatter have moved the
//                fit? Viscosities of the flowing points are drawn from the fitted model with the
//                variance relative_error^2 + scatter^2 N/(N - parameters) and fitted again; jammed
//                points stay as they are (B. Efron, Ann. Stat. 7, 1, 1979: percentile intervals).
//   profile      which values of one parameter are compatible with the data if all others, scatter
//                included, may follow? Those with a deviance at most z^2 above the smallest, z the
//                two-sided normal quantile. It finds what the data do not determine: an interval is
//                open where it reaches the limit up to which the fit looks.
//   fit_ranges   does the result depend on the range of the data, i.e. is the model wrong?
// The first two take the scatter as independent between points; where the model fails in the same
// way at neighbouring points, they are too short, and only the third can tell.
//
// Tests: coverage of the truth, the deviance at the ends of a profile, an undetermined parameter.
#pragma once
#include "engine/wyart_cates_fit.h"

#include <cstdint>
#include <vector>

namespace sigmaflow {

struct Interval {
    double lower = 0, upper = 0;
    bool open_below = false, open_above = false;  // reaches the limit of the parameter
};

/// One model for each of `samples` sets of drawn viscosities. Errors: input.
std::vector<WyartCates> bootstrap_wyart_cates(std::span<const WyartCatesPoint> points,
                                              const WyartCatesVariant& variant,
                                              const WyartCatesFit& fit, int samples,
                                              std::uint64_t seed);

/// That holds the share `confidence` in (0, 1) of the values, which must not be empty, between
/// equal shares (1 - confidence)/2; linear between order statistics.
Interval percentile_interval(std::vector<double> values, double confidence);

/// Of a free parameter. Errors: input.
Interval profile_interval(std::span<const WyartCatesPoint> points, const WyartCatesVariant& variant,
                          const WyartCatesFit& fit, WyartCatesParameter parameter,
                          double confidence);

/// The points with volume_fraction <= highest_fraction and stresses between the two.
struct FitRange {
    double highest_fraction = 0, lowest_stress = 0, highest_stress = 0;
};
std::vector<WyartCatesPoint> points_in(const FitRange& range,
                                       std::span<const WyartCatesPoint> points);

/// All points; without the highest volume fraction; without the two highest; without the lowest
/// stress; without the highest. Empty if there are no points.
std::vector<FitRange> fit_ranges(std::span<const WyartCatesPoint> points);

}
