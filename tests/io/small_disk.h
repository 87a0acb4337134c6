// tests/io/small_disk.h -- runs an action in a child process in which files cannot grow beyond a
// limit: a full disk that needs no root. SIGXFSZ is ignored, so write() fails with EFBIG.
#pragma once
#include "engine/error.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <exception>

namespace sigmaflow::testing_io {

/// Exit code of the child: 0 if the action ended, the kind of its Error, 1 for another exception,
/// or 128 + the signal that killed it.
template <class Action>
int with_file_size_limit(rlim_t bytes, const Action& action)
{
    const pid_t child = ::fork();
    if (child == 0) {
        const rlimit limit{bytes, bytes};
        ::setrlimit(RLIMIT_FSIZE, &limit);
        ::signal(SIGXFSZ, SIG_IGN);
        ::alarm(60);  // a library that tries for ever is a failure, too
        int code = 0;
        try {
            action();
        } catch (const Error& error) {
            code = static_cast<int>(error.kind());
        } catch (const std::exception&) {
            code = 1;
        }
        std::exit(code);  // with all that libraries do at the end of a program
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}
