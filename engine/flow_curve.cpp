#include "engine/flow_curve.h"

#include "engine/error.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace sigmaflow {

namespace {

void require(bool good, const std::string& problem)
{
    if (!good) throw Error(ErrorKind::input, "flow curve", problem);
}

/// By stress, up to the first jammed one.
std::vector<FlowPoint> usable(std::span<const FlowPoint> points)
{
    std::vector<FlowPoint> sorted(points.begin(), points.end());
    for (const FlowPoint& p : sorted)
        require(std::isfinite(p.stress) && std::isfinite(p.shear_rate) && p.standard_error >= 0 &&
                    std::isfinite(p.standard_error),
                "has a point that is not finite");
    std::sort(sorted.begin(), sorted.end(),
              [](const FlowPoint& a, const FlowPoint& b) { return a.stress < b.stress; });
    for (std::size_t k = 1; k < sorted.size(); ++k)
        require(sorted[k - 1].stress < sorted[k].stress,
                "has two points at the stress " + std::to_string(sorted[k].stress));
    const auto jammed =
        std::find_if(sorted.begin(), sorted.end(), [](const FlowPoint& p) { return p.jammed; });
    if (jammed != sorted.end()) {
        *jammed = {jammed->stress, 0, 0, true};
        sorted.erase(jammed + 1, sorted.end());
    }
    return sorted;
}

Slope slope_between(const FlowPoint& a, const FlowPoint& b, double z)
{
    const double width = b.stress - a.stress;
    Slope s{.from = a.stress, .to = b.stress, .slope = (b.shear_rate - a.shear_rate) / width};
    const double error = z * std::hypot(a.standard_error, b.standard_error) / width;
    s.lower = s.slope - error;
    s.upper = s.slope + error;
    s.trend = s.lower > 0 ? Trend::rises : s.upper < 0 ? Trend::falls : Trend::unknown;
    return s;
}

/// A fall by more of its errors comes first.
bool is_more_certain(const Slope& a, const Slope& b)
{
    return a.slope * (b.upper - b.lower) < b.slope * (a.upper - a.lower);
}

/// Sets the most significant fall; true if the rate rises again from the end of some fall.
bool find_falls(const std::vector<FlowPoint>& curve, double z, std::optional<Slope>& fall)
{
    bool rises_again = false;
    for (std::size_t j = 1; j < curve.size(); ++j) {
        bool falls = false;
        for (std::size_t i = 0; i < j; ++i) {
            const Slope s = slope_between(curve[i], curve[j], z);
            if (s.trend != Trend::falls) continue;
            falls = true;
            if (!fall || is_more_certain(s, *fall)) fall = s;
        }
        for (std::size_t k = j + 1; falls && k < curve.size(); ++k)
            rises_again |= slope_between(curve[j], curve[k], z).trend == Trend::rises;
    }
    return rises_again;
}

}

std::string_view shape_name(CurveShape shape)
{
    switch (shape) {
        case CurveShape::continuous:
            return "continuous";
        case CurveShape::s_shaped:
            return "S-shaped";
        case CurveShape::arch:
            return "arch-shaped";
        case CurveShape::undecided:
            break;
    }
    return "undecided";
}

double two_sided_quantile(double probability)
{
    double low = 0, high = 40;  // P falls from 1 to less than the smallest double
    for (int k = 0; k < 200 && low < high; ++k) {
        const double z = (low + high) / 2;
        (std::erfc(z / std::numbers::sqrt2) > probability ? low : high) = z;
    }
    return low;
}

CurveAnalysis analyse_flow_curve(std::span<const FlowPoint> points, double confidence)
{
    require(confidence > 0 && confidence < 1, "must have a confidence between 0 and 1");
    require(points.size() >= 2, "needs at least two points");
    const std::vector<FlowPoint> curve = usable(points);
    CurveAnalysis result;
    result.jams = curve.back().jammed;
    if (result.jams) result.jamming_stress = curve.back().stress;
    if (curve.size() < 2) {  // jammed already at the lowest stress
        result.shape = CurveShape::arch;
        return result;
    }
    const auto points_used = static_cast<double>(curve.size());
    const double z = two_sided_quantile((1 - confidence) / (points_used * (points_used - 1) / 2));
    for (std::size_t k = 1; k < curve.size(); ++k)
        result.slopes.push_back(slope_between(curve[k - 1], curve[k], z));
    const bool rises_again = find_falls(curve, z, result.fall);
    const bool rises = std::all_of(result.slopes.begin(), result.slopes.end(),
                                   [](const Slope& s) { return s.trend == Trend::rises; });
    if (result.jams)
        result.shape = CurveShape::arch;
    else if (rises_again)
        result.shape = CurveShape::s_shaped;
    else if (rises)
        result.shape = CurveShape::continuous;
    return result;
}

}
