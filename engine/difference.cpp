#include "engine/difference.h"

#include "engine/error.h"
#include "engine/flow_curve.h"

#include <cmath>
#include <limits>

namespace sigmaflow {

Difference difference(const Estimate& first, const Estimate& second, int comparisons,
                      double confidence)
{
    if (comparisons < 1 || !(confidence > 0 && confidence < 1))
        throw Error(ErrorKind::input, "difference", "needs comparisons >= 1, confidence in (0, 1)");
    Difference result{.mean = second.mean - first.mean,
                      .standard_error = std::hypot(first.standard_error, second.standard_error)};
    if (result.mean != 0)
        result.in_errors = result.standard_error > 0
                               ? result.mean / result.standard_error
                               : std::copysign(std::numeric_limits<double>::max(), result.mean);
    result.significant =
        std::abs(result.in_errors) > two_sided_quantile((1 - confidence) / comparisons);
    return result;
}

}
