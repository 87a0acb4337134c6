// render/ticks.h -- round numbers for axes.
#pragma once
#include <string>
#include <vector>

namespace sigmaflow::render {

struct Tick {
    double value;
    std::string label;  // rich text; empty: a minor tick
};

struct Range {
    double from, to;  // from < to
};

/// Step 1, 2, 2.5 or 5 times a power of ten, such that a range of this length has at most
/// `most_steps` of them. length > 0
double round_step(double length, int most_steps);

/// Ticks in [from, to] including both ends, ascending.
std::vector<Tick> linear_ticks(Range range, int most_steps = 6);

/// Ticks at 1, 10, 100, ...; below two decades also labels at 2 and 5; below half a decade, where
/// even those are too few, ticks as on a linear axis. range.from > 0
std::vector<Tick> log_ticks(Range range);

/// Whole numbers only, at most 8 steps of integer_step.
std::vector<Tick> integer_ticks(Range range);
double integer_step(double length);

/// The smallest range with round ends that holds the given one; a single value gets room around it.
Range round_linear_range(Range data);
Range round_log_range(Range data);  // data.from > 0

/// A number as rich text with a real minus sign; `decimals` digits after the point.
std::string fixed_label(double value, int decimals);

/// 10^{exponent} as rich text, with 1 and 10 written out.
std::string power_label(int exponent);

}
