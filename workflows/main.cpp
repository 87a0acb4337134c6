// The program `sigmaflow`: the command line, the only catch and the only exit code.
#include "engine/error.h"
#include "workflows/blas_kernel.h"
#include "workflows/commands.h"
#include "workflows/json_lines.h"
#include "workflows/manifest.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstring>
#include <iostream>

namespace {

using namespace sigmaflow;

/// What was wrong, on stderr; with --json as an event on stdout, too. Returns the exit code.
int complain(const Error& error, bool json)
{
    std::cerr << workflows::complaint(error);
    try {
        if (const auto* several = json ? dynamic_cast<const Errors*>(&error) : nullptr)
            for (const Error& one : several->list())
                workflows::print_json(workflows::error_event(one));
        else if (json)
            workflows::print_json(workflows::error_event(error));
    } catch (const Error&) {  // nobody reads stdout: the first error is the one to report
    }
    return static_cast<int>(error.kind());
}

void run_command_line(int argc, char** argv)
{
    CLI::App app(std::string(workflows::program_summary));
    app.set_version_flag("--version", "sigmaflow " + workflows::version());
    const auto chosen = workflows::declare_commands(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& help_or_version) {
        app.exit(help_or_version);
        return workflows::print_result("");
    }
    if (const workflows::Work work = chosen())
        work();
    else
        workflows::print_result(app.help());
}

}

int main(int argc, char** argv)
{
    workflows::choose_blas_kernel(argv);
    // asked of the words themselves: the command line may be what is wrong
    const bool json = std::any_of(argv, argv + argc,
                                  [](const char* word) { return !std::strcmp(word, "--json"); });
    try {
        run_command_line(argc, argv);
        return 0;
    } catch (const CLI::ParseError& error) {
        return complain(
            Error(ErrorKind::usage, "", std::string(error.what()) + " (sigmaflow --help)"), json);
    } catch (const workflows::Verdict& verdict) {
        return complain(verdict, false);
    } catch (const Error& error) {
        return complain(error, json);
    } catch (const std::exception& error) {
        return complain(
            Error(ErrorKind::internal, "", std::string("internal error: ") + error.what()), json);
    } catch (...) {
        return complain(Error(ErrorKind::internal, "", "internal error of unknown kind"), json);
    }
}
