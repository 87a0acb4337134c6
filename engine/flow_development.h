// engine/flow_development.h -- a small disturbance of uniform flow in a gap, followed from its
// first growth or decay to where it ends, beside the linear theory.
//
// Integrated by engine/one_dimensional_flow.h between walls of imposed stress, with the first mode
// disturbed. Rates, stresses and times (1/rate) are over those of the uniform flow. Growth
// and frequency are measured by engine/exponents.h where the mode is still smaller than 1e-3 of the
// rate, and all roots but the first two have died out by exp(-8).
//
// Tests: a stable, an unstable and an overdamped case.
#pragma once
#include "engine/constitution.h"
#include "engine/stability.h"

#include <complex>
#include <optional>
#include <vector>

namespace sigmaflow {

struct DevelopmentPlan {
    double reynolds = 0;
    int cells = 32;
    double disturbance = 1e-6;  // of the rate
    double time = 0;            //
    double step = 0;            //
    int steps_between_samples = 5;
};

/// Steps of 1/40 of the fastest of the first two roots; time for the growth to the size of the rate
/// and ten oscillations more, or for the decay by exp(-8), at most 40 000 steps. Errors: input.
DevelopmentPlan plan_development(const MemoryFlow& theory, double reynolds, double disturbance);

struct Moment {
    double time = 0;
    double amplitude = 0;      // of the first mode in the rate
    double mean_rate = 1;      // over the gap: what a rheometer shows
    double middle_stress = 1;  // at H/2
    std::vector<double> rate;  // of each volume, from y = 0
};

enum class Fate {
    decays,      // smaller than at the start
    oscillates,  // at a steady size
    changing,    // neither yet
};

struct Development {
    std::vector<Moment> moments;
    std::complex<double> expected = {};                 // the first root
    std::optional<std::complex<double>> measured = {};  // nothing: too few values
    Fate fate = Fate::changing;
    double smallest_rate = 1, largest_rate = 1;  // in the last quarter
    double frequency = 0;                        // angular, in the last quarter; 0: none
    bool broke_off = false;                      // the stresses did not converge
};

Development develop(const Constitution& constitution, const MemoryFlow& theory,
                    const DevelopmentPlan& plan);

}
