#include "engine/adaptive_curve.h"

#include "engine/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sigmaflow {

namespace {

bool flows(const FlowPoint& p)
{
    return !p.jammed && p.shear_rate > 0;
}

/// d ln rate/d ln stress between two flowing points.
struct LogSlope {
    double slope = 0, error = 0;
};

LogSlope log_slope(const FlowPoint& a, const FlowPoint& b)
{
    const double width = std::log(b.stress / a.stress);
    const double error =
        std::hypot(a.standard_error / a.shear_rate, b.standard_error / b.shear_rate);
    return {std::log(b.shear_rate / a.shear_rate) / width, error / width};
}

/// What is not known of ln rate between the points i and i + 1.
double uncertainty(const std::vector<FlowPoint>& p, std::size_t i)
{
    if (flows(p[i]) != flows(p[i + 1])) return std::numeric_limits<double>::infinity();
    if (!flows(p[i])) return 0;
    const LogSlope here = log_slope(p[i], p[i + 1]);
    const double width = std::log(p[i + 1].stress / p[i].stress);
    double change = 0;
    const auto compare = [&](std::size_t j) {
        if (!flows(p[j]) || !flows(p[j + 1])) return;
        const LogSlope there = log_slope(p[j], p[j + 1]);
        const double noise = 2 * std::hypot(here.error, there.error);
        change = std::max(change, std::abs(there.slope - here.slope) - noise);
    };
    if (i > 0) compare(i - 1);
    if (i + 2 < p.size()) compare(i + 1);
    return change * width / 8;
}

}

CurveTasks next_curve_tasks(std::span<const FlowPoint> points, const CurveGoal& goal)
{
    if (points.size() < 2 || !(goal.tolerance > 0) || !(goal.closest > 1) || goal.most_points < 2)
        throw Error(ErrorKind::input, "adaptive curve",
                    "needs two points, tolerance > 0, closest > 1 and most_points >= 2");
    std::vector<FlowPoint> sorted(points.begin(), points.end());
    std::sort(sorted.begin(), sorted.end(),
              [](const FlowPoint& a, const FlowPoint& b) { return a.stress < b.stress; });
    CurveTasks tasks;
    for (const FlowPoint& p : sorted)
        if (flows(p) && p.standard_error > goal.tolerance * p.shear_rate)
            tasks.lengthen.push_back(p.stress);

    struct Candidate {
        double uncertainty, stress;
    };
    std::vector<Candidate> candidates;
    for (std::size_t i = 0; i + 1 < sorted.size(); ++i) {
        const double from = sorted[i].stress, to = sorted[i + 1].stress;
        if (!(from > 0 && to > from))
            throw Error(ErrorKind::input, "adaptive curve", "needs different stresses > 0");
        const double unknown = uncertainty(sorted, i);
        if (unknown > goal.tolerance && to > goal.closest * goal.closest * from)
            candidates.push_back({unknown, std::sqrt(from * to)});
    }
    std::stable_sort(
        candidates.begin(), candidates.end(),
        [](const Candidate& a, const Candidate& b) { return a.uncertainty > b.uncertainty; });
    const std::size_t most = static_cast<std::size_t>(goal.most_points);
    for (const Candidate& c : candidates)
        if (sorted.size() + tasks.insert.size() < most) tasks.insert.push_back(c.stress);
    return tasks;
}

}
