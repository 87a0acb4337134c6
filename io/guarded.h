// io/guarded.h -- reading a file of unknown origin with a library that a hostile file can crash.
//
// The work is done by a child process with limits on memory, CPU time and wall time, without core
// dumps and with its standard error closed; its answer comes back through a pipe. Whatever happens
// to the child, this process goes on: it gets the answer or an Error.
#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

namespace sigmaflow::io {

struct GuardLimits {
    std::size_t memory = std::size_t{96} << 20;  // bytes beyond what is in use already
    int cpu_seconds = 1;
    int wall_seconds = 20;  // a disk may be slow
};

/// More for a larger file: the limits are for files that ask for what they do not have.
GuardLimits limits_for(const std::filesystem::path& file);

/// What `read` returns. An Error that it throws is thrown here; one that it can only die of becomes
/// Error(input) for `file`: stopped by a signal, out of memory or out of time. Other exceptions
/// become Error(input) too. Error(internal) if no process can be started.
std::string guarded(const std::filesystem::path& file, const GuardLimits& limits,
                    const std::function<std::string()>& read);

}
