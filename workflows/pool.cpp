#include "workflows/pool.h"

#include "engine/error.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <deque>
#include <thread>

namespace sigmaflow::workflows {

namespace {

using Clock = std::chrono::steady_clock;

constexpr auto pause = std::chrono::milliseconds(20);
constexpr auto between_tries = std::chrono::seconds(1);
constexpr int most_tries = 20;
constexpr std::string_view code_words = "exit code ";

struct Running {
    std::size_t job;
    pid_t process;
};

struct Waiting {
    std::size_t job;
    Clock::time_point from;
};

/// A file descriptor that is closed in time.
class Descriptor {
public:
    Descriptor(const std::filesystem::path& path, int flags)
        : value_(::open(path.c_str(), flags | O_CLOEXEC, 0666))
    {
        if (value_ < 0)
            throw Error(ErrorKind::file, path.string(),
                        std::string("cannot be opened: ") + std::strerror(errno));
    }
    ~Descriptor() { ::close(value_); }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int value() const { return value_; }

private:
    int value_;
};

/// In the new process: only what may be done between fork and exec.
[[noreturn]] void become(char* const* arguments, const char* folder, int input, int log,
                         pid_t parent)
{
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    const bool orphan = getppid() != parent;  // it ended before it could be watched
    if (!orphan && chdir(folder) == 0 && dup2(input, STDIN_FILENO) >= 0 &&
        dup2(log, STDOUT_FILENO) >= 0 && dup2(log, STDERR_FILENO) >= 0)
        execv(arguments[0], arguments);
    constexpr int cannot_start = 127;
    _exit(cannot_start);
}

pid_t start(const Job& job)
{
    std::vector<std::string> words = job.command;
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const Descriptor log(job.log, O_WRONLY | O_CREAT | O_APPEND), input("/dev/null", O_RDONLY);
    const pid_t parent = getpid(), child = fork();
    if (child < 0)
        throw Error(ErrorKind::file, job.command.front(),
                    std::string("cannot be started: ") + std::strerror(errno));
    if (child == 0)
        become(arguments.data(), job.folder.c_str(), input.value(), log.value(), parent);
    return child;
}

void note_end(const Job& job, int code)
{
    const Descriptor log(job.log, O_WRONLY | O_CREAT | O_APPEND);
    const std::string line = std::string(code_words) + std::to_string(code) + "\n";
    // the pool goes on without it: the point only counts as interrupted then
    [[maybe_unused]] const ssize_t written = ::write(log.value(), line.data(), line.size());
}

/// Its exit code if it has ended.
std::optional<int> end_of(pid_t process)
{
    int status = 0;
    const pid_t ended = waitpid(process, &status, WNOHANG);
    if (ended == 0 || (ended < 0 && errno == EINTR)) return std::nullopt;
    if (ended < 0) return static_cast<int>(ErrorKind::internal);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// The processes of a pool; ends them if an error ends the pool.
class Processes {
public:
    ~Processes()
    {
        stop();
        for (const Running& one : running_)
            while (waitpid(one.process, nullptr, 0) < 0 && errno == EINTR) {
            }
    }

    void add(std::size_t job, const Job& what) { running_.push_back({job, start(what)}); }

    void stop()
    {
        for (const Running& one : running_) kill(one.process, SIGTERM);
    }

    std::size_t count() const { return running_.size(); }

    /// Calls `ended` with the number and the exit code of every job that has ended.
    void collect(const std::function<void(std::size_t, int)>& ended)
    {
        std::vector<Running> left;
        std::vector<std::pair<std::size_t, int>> done;
        for (const Running& one : running_)
            if (const auto code = end_of(one.process))
                done.emplace_back(one.job, *code);
            else
                left.push_back(one);
        running_ = std::move(left);
        for (const auto& [job, code] : done) ended(job, code);
    }

private:
    std::vector<Running> running_;
};

}

PoolState run_pool(std::span<const Job> jobs, std::size_t width, int busy_code,
                   const std::function<bool()>& asked_to_stop,
                   const std::function<void(const PoolState&)>& watch)
{
    PoolState state;
    state.codes.resize(jobs.size());
    std::deque<Waiting> waiting;
    for (std::size_t k = 0; k < jobs.size(); ++k) waiting.push_back({k, Clock::now()});
    std::vector<int> tries(jobs.size(), 0);
    Processes processes;
    bool stopping = false;
    Clock::time_point told{};
    while (processes.count() > 0 || (!stopping && !waiting.empty())) {
        stopping = stopping || asked_to_stop();
        // again and again: a process that has just begun may have missed it
        if (stopping && Clock::now() - told >= between_tries) {
            processes.stop();
            told = Clock::now();
        }
        while (!stopping && processes.count() < width && !waiting.empty() &&
               waiting.front().from <= Clock::now()) {
            processes.add(waiting.front().job, jobs[waiting.front().job]);
            ++tries[waiting.front().job];
            waiting.pop_front();
        }
        state.running = processes.count();
        watch(state);
        std::this_thread::sleep_for(pause);
        processes.collect([&](std::size_t job, int code) {
            note_end(jobs[job], code);
            if (code == busy_code && tries[job] < most_tries && !stopping) {
                waiting.push_back({job, Clock::now() + between_tries});
                return;
            }
            state.codes[job] = code;
            ++state.ended;
        });
        state.running = processes.count();
    }
    watch(state);
    return state;
}

std::optional<int> exit_code_in(const std::string& log)
{
    const auto end = log.find_last_not_of('\n');
    if (end == std::string::npos) return std::nullopt;
    const auto begin = log.rfind('\n', end);
    const std::string line = log.substr(begin == std::string::npos ? 0 : begin + 1);
    if (!line.starts_with(code_words)) return std::nullopt;
    int code = 0;
    const char* first = line.data() + code_words.size();
    if (std::from_chars(first, line.data() + line.size(), code).ec != std::errc())
        return std::nullopt;
    return code;
}

}
