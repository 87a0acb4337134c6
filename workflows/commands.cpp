#include "workflows/commands.h"

#include <CLI/CLI.hpp>
#include <array>
#include <iostream>

namespace sigmaflow::workflows {

std::span<const Command> commands()
{
    static const std::array list{run_command(),    validate_command(), evaluate_command(),
                                 report_command(), render_command(),   steps_command()};
    return list;
}

namespace {

constexpr const char* program_help = R"(examples:
  sigmaflow run workflows/quickstart.json             results in out/quickstart
  sigmaflow steps shear                               the parameters of one step
  sigmaflow validate my_flow.json                     what is wrong with a workflow
  sigmaflow report out/quickstart                     one HTML page of a run: report.html
  sigmaflow render out/quickstart --view front        a new picture of its last frame
  sigmaflow run --help                                options and examples of a command

a run that was interrupted or killed goes on with the same command

exit codes: 0 complete, 3 interrupted (the same command goes on), 64 wrong command line, 65 invalid
input, 66 input missing, 69 pictures could not be drawn, 70 numerical failure, 71 internal error,
73 cannot write, 74 disk full, 75 folder in use)";

}

std::function<Work()> declare_commands(CLI::App& app)
{
    app.require_subcommand(0, 1);
    app.footer(program_help);
    std::vector<std::pair<const CLI::App*, Work>> declared;
    for (const Command& command : commands()) {
        CLI::App* sub = app.add_subcommand(std::string(command.name), std::string(command.summary));
        sub->footer("examples:\n" + std::string(command.examples));
        declared.emplace_back(sub, command.declare(*sub));
    }
    return [declared] {
        for (const auto& [sub, work] : declared)
            if (sub->parsed()) return work;
        return Work();
    };
}

std::string complaint(const Error& error)
{
    const char* what = error.kind() == ErrorKind::interrupted ? "interrupted: " : "error: ";
    return std::string("sigmaflow: ") + what + error.what() + "\n";
}

void print_result(std::string_view text)
{
    std::cout << text << std::flush;
    if (!std::cout) throw Error(ErrorKind::file, "standard output", "cannot be written");
}

void need_text(std::string_view option, std::string_view text, std::string_view requirement)
{
    if (text.empty())
        throw Error(ErrorKind::usage, std::string(option), std::string(requirement) + ", got \"\"");
}

}
