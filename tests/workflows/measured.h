// Runs a program and measures what it takes: CPU time and memory of it and of the children that it
// waited for. Ends it if it hangs.
#pragma once
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <filesystem>
#include <string>
#include <vector>

namespace sigmaflow::workflows {

struct Measured {
    int exit_code = -1;  // 128 + n if signal n ended the program
    double cpu_seconds = 0;
    double megabytes = 0;  // most memory that was resident at once
};

/// Standard input is empty, output and error go to the files `out` and `err`.
inline Measured run_measured(const std::string& program, const std::vector<std::string>& arguments,
                             const std::filesystem::path& folder, const std::filesystem::path& out,
                             const std::filesystem::path& err)
{
    constexpr unsigned hangs_after = 60;  // s; the machine may be busy
    std::vector<char*> words{const_cast<char*>(program.c_str())};
    for (const std::string& argument : arguments)
        words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    const pid_t child = ::fork();
    if (child == 0) {
        const auto use = [](const char* path, int flags, int descriptor) {
            ::dup2(::open(path, flags, 0600), descriptor);
        };
        use("/dev/null", O_RDONLY, STDIN_FILENO);
        use(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, STDOUT_FILENO);
        use(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, STDERR_FILENO);
        ::alarm(hangs_after);
        if (::chdir(folder.c_str()) == 0) ::execv(program.c_str(), words.data());
        ::_exit(127);
    }
    int status = 0;
    rusage usage{};
    if (::wait4(child, &status, 0, &usage) != child) return {};
    const auto seconds = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
            seconds(usage.ru_utime) + seconds(usage.ru_stime),
            static_cast<double>(usage.ru_maxrss) / 1024};
}

}
