// workflows/pool.h -- runs programs side by side, so many at a time.
//
// The programs are given SIGTERM when the pool is asked to stop, and when this process ends in any
// way, a kill included (PR_SET_PDEATHSIG); nothing new is started then, and the pool waits for
// those that run. They stand in process groups of their own, so that Ctrl-C reaches them once, by
// the pool. What they print goes to the end of their log, and after it "exit code N" (128 + n if
// signal n ended it).
// Errors: file (no process can be started, the log cannot be opened).
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace sigmaflow::workflows {

struct Job {
    std::vector<std::string> command;  // the program and its arguments
    std::filesystem::path folder;      // that it works in
    std::filesystem::path log;
};

struct PoolState {
    std::size_t running = 0, ended = 0;
    std::vector<std::optional<int>> codes;  // of each job: its exit code when it has ended
};

/// Ends when all jobs have ended, or when it was asked to stop and no job runs any more. `watch` is
/// called after every change and about ten times a second. A job that ends with `busy_code` is
/// started again, up to 20 times, a second apart: what it needs is still in use.
PoolState run_pool(std::span<const Job> jobs, std::size_t width, int busy_code,
                   const std::function<bool()>& asked_to_stop,
                   const std::function<void(const PoolState&)>& watch);

/// The last line of a log that a job has ended with; nothing if it runs or was killed with the
/// pool.
std::optional<int> exit_code_in(const std::string& log);

}
