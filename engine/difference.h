// engine/difference.h -- do two measured means differ?
//
// The difference of two independent means over its standard error, the root of the sum of their
// squares, is normal if they do not. Several comparisons at once: each at the level
// (1 - confidence)/m (Bonferroni), so that all statements hold together with the confidence.
#pragma once
#include "engine/statistics.h"

namespace sigmaflow {

struct Difference {
    double mean = 0, standard_error = 0;  // second minus first
    double in_errors = 0;                 // 0 if there is neither difference nor error
    bool significant = false;
};

/// `comparisons` >= 1 made at once; `confidence` in (0, 1). Errors: input.
Difference difference(const Estimate& first, const Estimate& second, int comparisons,
                      double confidence = 0.95);

}
