#include "io/guarded.h"

#include "engine/error.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <new>
#include <optional>

namespace sigmaflow::io {
namespace {

using Clock = std::chrono::steady_clock;

/// What the child says: the kind of the Error, 0 for a result, and texts that end with a NUL byte.
struct Answer {
    int kind = 0;
    std::string where, text;
};

void limit(int resource, rlim_t value)
{
    rlimit limits{};
    if (::getrlimit(resource, &limits) != 0) return;
    limits.rlim_cur = std::min(value, limits.rlim_max);
    ::setrlimit(resource, &limits);
}

std::size_t memory_in_use()
{
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

void apply(const GuardLimits& limits)
{
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    ::prctl(PR_SET_DUMPABLE, 0);  // RLIMIT_CORE does not stop a program that collects dumps
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_CPU, static_cast<rlim_t>(limits.cpu_seconds));
    limit(RLIMIT_AS, memory_in_use() + limits.memory);
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nowhere >= 0) ::dup2(nowhere, STDERR_FILENO);
}

Answer answer_of(const std::function<std::string()>& read, const GuardLimits& limits)
{
    const int input = static_cast<int>(ErrorKind::input);
    try {
        return {0, "", read()};
    } catch (const Error& error) {
        return {static_cast<int>(error.kind()), error.where(), error.problem()};
    } catch (const std::bad_alloc&) {
        return {input, "",
                "cannot be read safely: needs more than " + std::to_string(limits.memory >> 20) +
                    " MiB of memory"};
    } catch (const std::exception& error) {
        return {input, "", std::string("cannot be read: ") + error.what()};
    }
}

[[noreturn]] void run_child(int pipe, const GuardLimits& limits,
                            const std::function<std::string()>& read)
{
    apply(limits);
    const Answer answer = answer_of(read, limits);
    const std::string message =
        std::to_string(answer.kind) + '\0' + answer.where + '\0' + answer.text + '\0';
    for (std::size_t sent = 0; sent < message.size();) {
        const ssize_t written = ::write(pipe, message.data() + sent, message.size() - sent);
        if (written < 0 && errno != EINTR) ::_exit(1);
        if (written > 0) sent += static_cast<std::size_t>(written);
    }
    ::_exit(0);  // nothing of the parent is flushed or destroyed twice
}

/// All that comes before the child closes its end; nothing if it takes too long.
std::optional<std::string> received(int pipe, Clock::time_point until)
{
    std::string text;
    std::array<char, 4096> buffer;
    while (true) {
        const auto left =
            std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now());
        if (left.count() <= 0) return std::nullopt;
        pollfd waiting{pipe, POLLIN, 0};
        if (::poll(&waiting, 1, static_cast<int>(left.count())) <= 0) continue;
        const ssize_t got = ::read(pipe, buffer.data(), buffer.size());
        if (got == 0) return text;
        if (got > 0) text.append(buffer.data(), static_cast<std::size_t>(got));
    }
}

std::optional<Answer> parsed(const std::string& message)
{
    const std::size_t first = message.find('\0');
    const std::size_t second = message.find('\0', first + 1);
    if (first == std::string::npos || second == std::string::npos || message.back() != '\0')
        return std::nullopt;
    return Answer{std::atoi(message.c_str()), message.substr(first + 1, second - first - 1),
                  message.substr(second + 1, message.size() - second - 2)};
}

std::string death(int status, const GuardLimits& limits)
{
    if (!WIFSIGNALED(status)) return "the library that reads it ended the process";
    const int signal = WTERMSIG(status);
    if (signal == SIGXCPU)
        return "took more than " + std::to_string(limits.cpu_seconds) + " s of computing";
    return "the library that reads it crashed (signal " + std::to_string(signal) + ", " +
           ::strsignal(signal) + ")";
}

}

GuardLimits limits_for(const std::filesystem::path& file)
{
    const std::size_t megabytes = std::filesystem::file_size(file) >> 20;
    GuardLimits limits;
    limits.memory += std::min(megabytes, std::size_t{1024}) << 20;
    limits.cpu_seconds += static_cast<int>(std::min(megabytes / 20, std::size_t{100'000}));
    limits.wall_seconds += 4 * limits.cpu_seconds;
    return limits;
}

std::string guarded(const std::filesystem::path& file, const GuardLimits& limits,
                    const std::function<std::string()>& read)
{
    const auto refuse = [&](const std::string& problem) {
        throw Error(ErrorKind::input, file.string(), "cannot be read safely: " + problem);
    };
    const auto no_process = [&] {
        return Error(ErrorKind::internal, file.string(),
                     std::string("no process to read it in: ") + std::strerror(errno));
    };
    std::array<int, 2> pipe{};
    if (::pipe2(pipe.data(), O_CLOEXEC) != 0) throw no_process();
    const pid_t child = ::fork();
    if (child < 0) {
        const Error error = no_process();
        ::close(pipe[0]);
        ::close(pipe[1]);
        throw error;
    }
    if (child == 0) run_child(pipe[1], limits, read);

    ::close(pipe[1]);
    const auto message =
        received(pipe[0], Clock::now() + std::chrono::seconds(limits.wall_seconds));
    ::close(pipe[0]);
    if (!message) ::kill(child, SIGKILL);
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (!message) refuse("took more than " + std::to_string(limits.wall_seconds) + " s");
    const auto answer = parsed(*message);
    if (!answer) refuse(death(status, limits));
    if (answer->kind == 0) return answer->text;
    throw Error(static_cast<ErrorKind>(answer->kind),
                answer->where.empty() ? file.string() : answer->where, answer->text);
}

}
