// engine/jamming.h -- is the suspension jammed under the imposed stress?
//
// Judged over windows of time T_w = gamma_w eta_J/sigma. Jammed: in the last window the strain grew
// by less than gamma_w (the mean viscosity exceeds eta_J) and the forces of contacts and repulsion
// balance on every particle within a hundredth of the largest pair force. A rate that is negative
// for a while is elastic recoil and counts with its sign. Jamming is a result, not an error: in a
// jammed state springs and repulsion carry all of the stress (Mari et al., Phys. Rev. E 91, 052302,
// 2015, section II).
#pragma once
#include "engine/evaluation.h"
#include "engine/state.h"
#include "engine/value.h"

#include <functional>
#include <span>

namespace sigmaflow {

struct JammingCriterion {
    double viscosity = 1e5;  // eta_J [eta0] > 0
    double strain = 1e-3;    // gamma_w [-] > 0
    double residual = 0.01;  // [-] > 0
};

/// Largest net force of contacts and repulsion on a particle over the largest pair force [-]; 0 if
/// nothing acts.
double force_residual(const State& state, const Model& model, const Control& control);

/// What the last complete window said.
struct JammingWindow {
    double duration = 0;        // [1/rate0]
    double strain_gain = 0;     // [-]
    double mean_viscosity = 0;  // sigma duration/strain_gain [eta0]
    double force_residual = 0;  // at its end [-]
    bool jammed = false;
};

template <class Archive>
void archive(Archive& a, JammingWindow& w)
{
    a(w.duration, w.strain_gain, w.mean_viscosity, w.force_residual, w.jammed);
}

/// A suspension flows at the stress `flows` and jams at `jams` [sigma0]; 0: not known (it flows at
/// all stresses that were tried, or at none).
struct JammingBracket {
    double flows = 0, jams = 0;
};

/// Bisects the logarithm of the stress from [low, high] until jams/flows <= ratio, with
/// jams(stress) asked for both ends first. Errors: input (needs 0 < low < high, ratio > 1).
JammingBracket bracket_jamming_stress(double low, double high, double ratio,
                                      const std::function<bool(double)>& jams);

/// The stress of jamming from the brackets of independent starts, at least one, all with two ends:
/// the geometric mean of their middles. The error has the scatter of ln stress and the width of the
/// brackets, in which the true value lies anywhere (variance width^2/12). Errors: input.
Value jamming_stress(std::span<const JammingBracket> brackets);

class JammingMonitor {
public:
    /// stress: the imposed one [sigma0] > 0
    explicit JammingMonitor(double stress, const JammingCriterion& criterion = {});

    /// To be called once a step; true when a window was completed and the suspension is jammed.
    bool observe(const State& state, const Evaluation& evaluation);

    const JammingWindow& last_window() const { return window_; }

    template <class Archive>
    void archive(Archive& a)
    {
        a(start_time_, start_strain_, started_, window_);
    }

private:
    JammingCriterion criterion_;
    double stress_, duration_;
    double start_time_ = 0, start_strain_ = 0;
    bool started_ = false;
    JammingWindow window_;
};

}
