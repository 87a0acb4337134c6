// workflows/interruption.h -- requests to stop: signals and the end of the wall time.
//
// SIGTERM, SIGINT, SIGHUP, SIGUSR1 and SIGXCPU ask a run to store a checkpoint and to end with exit
// code 3 after the step it is in; a second SIGINT ends the program at once with the same code (the
// checkpoint before stays valid). A signal that is ignored when the program starts stays ignored
// (nohup). SIGPIPE and SIGXFSZ do not end the program: the write fails and is reported.
#pragma once
#include <chrono>
#include <optional>
#include <string>

namespace sigmaflow::workflows {

/// Seconds of "90", "45s", "30m", "2h", "1d", "HH:MM:SS" or Slurm's "D-HH:MM:SS"; nothing if it is
/// none of these or not positive.
std::optional<double> seconds_of(const std::string& text);

class Interruption {
public:
    /// From now on signals are requests. `wall_time` [s]: the program must have ended by then.
    explicit Interruption(std::optional<double> wall_time);

    /// Why the run should stop, if it should: "SIGTERM", "the wall time of 2 h is nearly over".
    /// `needed` [s]: what ending takes, a step and a checkpoint.
    std::optional<std::string> asked(double needed = 0) const;

private:
    using Clock = std::chrono::steady_clock;
    std::optional<double> wall_time_;
    Clock::time_point started_ = Clock::now();
};

}
