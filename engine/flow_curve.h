// engine/flow_curve.h -- the shape of a flow curve, shear rate against imposed shear stress,
// decided from measured points with their errors.
//
//   continuous  the rate rises with the stress between all neighbouring points
//   s_shaped    it falls between two points, and rises again from there: discontinuous thickening
//   arch        the suspension jams at high stress: shear jamming
//   undecided   the errors, or the stresses that were measured (a rate that falls up to the highest
//               one may rise again or vanish), leave more than one of these open
// (the three shapes of Mari, Seto, Morris & Denn, Phys. Rev. E 91, 052302, 2015, Fig. 2 left).
// Every pair of the m = n (n - 1)/2 pairs of points is tested two-sided at the level
// (1 - confidence)/m (Bonferroni), so that all statements hold together with the confidence; errors
// are taken as normal and independent between points. Jammed points have the rate 0 without error
// and end the curve: what flows above a jammed stress is not used.
#pragma once
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace sigmaflow {

struct FlowPoint {
    double stress = 0;          // imposed [sigma0]
    double shear_rate = 0;      // mean [rate0]; 0 if jammed
    double standard_error = 0;  // of the rate, >= 0
    bool jammed = false;
};

enum class CurveShape { continuous, s_shaped, arch, undecided };
std::string_view shape_name(CurveShape shape);

enum class Trend { rises, falls, unknown };

/// The rate between two points.
struct Slope {
    double from = 0, to = 0;       // stresses [sigma0]
    double slope = 0;              // d rate/d stress [rate0/sigma0 = 1/eta0]
    double lower = 0, upper = 0;   // confidence interval of the slope, for all pairs at once
    Trend trend = Trend::unknown;  // whether the interval excludes 0
};

struct CurveAnalysis {
    CurveShape shape = CurveShape::undecided;
    std::vector<Slope> slopes;  // between neighbours, one less than there are points used
    std::optional<Slope> fall;  // the most significant fall of the rate
    bool jams = false;
    double jamming_stress = 0;  // the lowest jammed one [sigma0], if it jams
};

/// Points in any order, at different stresses. `confidence` in (0, 1). Errors: input (fewer than 2
/// points, equal stresses, what is not finite).
CurveAnalysis analyse_flow_curve(std::span<const FlowPoint> points, double confidence = 0.95);

/// z with P(|normal| > z) = probability in (0, 1).
double two_sided_quantile(double probability);

}
