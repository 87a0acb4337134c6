// engine/adaptive_curve.h -- which points of a flow curve to measure next, and which for longer.
//
// A flowing point whose rate has a relative standard error above the tolerance is measured for
// longer. Between neighbours the curve is unknown by about the error of linear interpolation of
// ln rate over ln stress, w |change of the slope| / 8 with the width w (that of a parabola), where
// the change of the slope counts beyond two of its standard errors only. An interval where that
// exceeds the tolerance is halved, the most uncertain one first; so is one between a flowing and a
// jammed point. No interval becomes narrower than the ratio `closest`, and there are at most
// `most_points` points.
//
// Tests: smooth, S-shaped and arch-shaped curves without noise are met within the tolerance with
// less than 1.6 times the points of equal intervals (for which one must know where the curve ends);
// noise alone asks for no points.
#pragma once
#include "engine/flow_curve.h"

#include <span>
#include <vector>

namespace sigmaflow {

struct CurveGoal {
    double tolerance = 0.05;  // of ln rate [-] > 0
    double closest = 1.1;     // ratio of neighbouring stresses > 1
    int most_points = 30;     // >= 2
};

struct CurveTasks {
    std::vector<double> lengthen;  // stresses of points [sigma0]
    std::vector<double> insert;    // new stresses [sigma0], the most needed first
};

/// Nothing to do: the goal is met, or out of reach of new points. Jammed points are not lengthened,
/// nor are rates <= 0. Errors: input (fewer than 2 points, equal stresses, a goal out of range).
CurveTasks next_curve_tasks(std::span<const FlowPoint> points, const CurveGoal& goal);

}
