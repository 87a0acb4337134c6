// workflows/recorder.h -- samples and frames at multiples of their strain intervals, and the end of
// a run.
#pragma once
#include "engine/evaluation.h"
#include "workflows/shearing.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <optional>

namespace sigmaflow::workflows {

/// Strains that differ by rounding only are the same.
inline bool reached(double strain, double target)
{
    return strain >= target - 1e-12 * std::max(1., target);
}

/// Multiples of an interval that still lie ahead.
class OutputClock {
public:
    explicit OutputClock(double interval) : interval_(interval) {}

    double next() const
    {
        return interval_ > 0 ? static_cast<double>(count_) * interval_
                             : std::numeric_limits<double>::infinity();
    }
    /// True once for every multiple that is reached.
    bool due(double strain)
    {
        if (!reached(strain, next())) return false;
        while (reached(strain, next())) ++count_;
        return true;
    }

    template <class Archive>
    void archive(Archive& a)
    {
        a(count_);
    }

private:
    double interval_;
    long count_ = 0;
};

/// Where the outputs of a run go.
struct Outputs {
    std::function<void(const Sample&, bool on_grid)> sample;
    std::function<void(const Frame&)> frame = {};  // empty: no frames are made
};

/// Makes the outputs that are due at the strain of the state and says when to stop.
class Recorder {
public:
    Recorder(const ShearingTask& task, Outputs outputs, const std::function<bool()>& enough)
        : task_(task),
          outputs_(std::move(outputs)),
          enough_(enough),
          samples_(task.series_interval),
          frames_(task.frame_interval)
    {
    }

    template <class Archive>
    void archive(Archive& a)
    {
        a(samples_, frames_);
    }

    /// The next output, or the end.
    double target() const { return std::min({samples_.next(), frames_.next(), task_.strain}); }

    /// Evaluates the state if there is something to record.
    std::optional<Evaluation> record(State& state, const Model& model, Workspace& workspace)
    {
        // a step that was cut at an output lands on it but for rounding
        if (reached(state.strain, target()) && reached(target(), state.strain))
            state.strain = target();
        arrived_ = reached(state.strain, task_.strain);
        last_ = arrived_ || state.time >= task_.time;
        const bool on_grid = samples_.due(state.strain), frame = frames_.due(state.strain);
        has_sample_ = has_frame_ = false;
        if (!on_grid && !frame && !last_) return std::nullopt;

        if (!outputs_.frame || (!frame && !last_)) {
            SampledEvaluation sampled = evaluate_sample(state, model, task_.control, workspace);
            write_sample(make_sample(state, sampled), on_grid);
            if (!outputs_.frame || !last_) return std::move(sampled.evaluation);
        }
        DetailedEvaluation detailed = evaluate_in_detail(state, model, task_.control, workspace);
        if (!has_sample_ && (on_grid || last_)) write_sample(make_sample(state, detailed), on_grid);
        write_frame(state, detailed);
        return std::move(detailed.evaluation);
    }

    /// Makes sure that the last state is recorded.
    void record_end(const State& state, const Model& model, Workspace& workspace)
    {
        if (has_sample_ && (has_frame_ || !outputs_.frame)) return;
        const DetailedEvaluation detailed =
            evaluate_in_detail(state, model, task_.control, workspace);
        if (!has_sample_) write_sample(make_sample(state, detailed), false);
        if (!has_frame_ && outputs_.frame) write_frame(state, detailed);
    }

    bool last() const { return last_; }
    bool arrived() const { return arrived_; }

private:
    void write_sample(const Sample& sample, bool on_grid)
    {
        outputs_.sample(sample, on_grid);
        has_sample_ = true;
        if (on_grid && enough_ && enough_()) last_ = true;
    }
    void write_frame(const State& state, const DetailedEvaluation& detailed)
    {
        outputs_.frame(make_frame(state, detailed));
        has_frame_ = true;
    }

    const ShearingTask& task_;
    Outputs outputs_;
    const std::function<bool()>& enough_;
    OutputClock samples_, frames_;
    bool last_ = false, arrived_ = false;  // of the state that was recorded last
    bool has_sample_ = false, has_frame_ = false;
};

}
