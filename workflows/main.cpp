// The program `sigmaflow`: the command line, the only catch and the only exit code.
#include "engine/error.h"
#include "workflows/blas_kernel.h"
#include "workflows/commands.h"
#include "workflows/manifest.h"

#include <CLI/CLI.hpp>
#include <iostream>

namespace {

using namespace sigmaflow;

int complain(const std::string& message)
{
    std::cerr << "sigmaflow: error: " << message << "\n";
    return static_cast<int>(ErrorKind::internal);
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
    try {
        run_command_line(argc, argv);
        return 0;
    } catch (const CLI::ParseError& error) {
        complain(std::string(error.what()) + " (sigmaflow --help)");
        return static_cast<int>(ErrorKind::usage);
    } catch (const Error& error) {
        std::cerr << workflows::complaint(error);
        return static_cast<int>(error.kind());
    } catch (const std::exception& error) {
        return complain(std::string("internal error: ") + error.what());
    } catch (...) {
        return complain("internal error of unknown kind");
    }
}
