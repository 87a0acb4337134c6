// workflows/falling_intervals.h -- the stability of uniform flow between the measured stresses of
// flow curves.
#pragma once
#include "engine/stability.h"
#include "workflows/measured_curves.h"
#include "workflows/memory_parameters.h"

#include <optional>
#include <vector>

namespace sigmaflow::workflows {

/// Between two neighbouring stresses of a curve.
struct Interval {
    double volume_fraction = 0, from = 0, to = 0;  // stresses [sigma0]
    MemoryFlow flow = {};
    std::optional<Onset> onset = {};

    double stress() const { return (from + to) / 2; }
    double rate() const { return stress() / flow.viscosity.mean; }
    /// The critical Reynolds number is known, but for an error smaller than itself; others stand in
    /// tables only.
    bool is_drawn() const { return onset && onset->reynolds.standard_error < onset->reynolds.mean; }
};

/// Jammed points, and rates that are not positive, end a curve.
std::vector<Interval> intervals_of(const Curves& curves, const MemoryParameters& memory);

/// Of intervals with an onset, that with the smallest Re_c of each volume fraction.
std::vector<Interval> least_stable(const std::vector<Interval>& falling);

}
