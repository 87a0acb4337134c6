#include "workflows/commands.h"

#include <unistd.h>
#include <CLI/CLI.hpp>
#include <array>
#include <iostream>
#include <memory>

namespace sigmaflow::workflows {

std::span<const Command> commands()
{
    static const std::array list{init_command(),       run_command(),    plan_command(),
                                 status_command(),     sweep_command(),  collect_command(),
                                 render_command(),     report_command(), compare_command(),
                                 validate_command(),   verify_command(), evaluate_command(),
                                 explain_command(),    schema_command(), doctor_command(),
                                 completion_command(), man_command()};
    return list;
}

namespace {

constexpr const char* program_help = R"(examples:
  sigmaflow init                                      my_flow.json, a workflow to start from
  sigmaflow run workflows/quickstart.json             results in out/quickstart
  sigmaflow explain shear                             the parameters of one step
  sigmaflow validate my_flow.json                     what is wrong with a workflow
  sigmaflow report out/quickstart                     one HTML page of a run: report.html
  sigmaflow render out/quickstart --view front        a new picture of its last frame
  sigmaflow run --help                                options and examples of a command

a run that was interrupted or killed goes on with the same command

exit codes: 0 complete, 1 compared runs differ, 3 interrupted (the same command goes on), 64 wrong command line, 65 invalid
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
    if (const auto* several = dynamic_cast<const Errors*>(&error)) {
        std::string lines;
        for (const Error& one : several->list()) lines += complaint(one);
        return lines;
    }
    const char* what = error.kind() == ErrorKind::interrupted ? "interrupted: "
                       : error.kind() == ErrorKind::different ? ""
                                                              : "error: ";
    return std::string("sigmaflow: ") + what + error.what() + "\n";
}

void describe_json(CLI::App& app, bool& json)
{
    app.add_flag("--json", json, "results and errors as JSON, one value per line, for programs");
}

std::function<std::vector<io::Override>()> declare_overrides(CLI::App& app)
{
    const auto given = std::make_shared<std::vector<std::string>>();
    app.add_option("--set", *given,
                   "another value than in the file, e.g. /steps/1/stress=3 (JSON pointer, steps "
                   "count from 0); may be given several times")
        ->allow_extra_args(false);
    return [given] {
        std::vector<io::Override> overrides;
        for (const std::string& text : *given)
            overrides.push_back(io::parse_override("--set", text));
        return overrides;
    };
}

void print_hint(std::string_view text)
{
    if (isatty(STDERR_FILENO) != 0) std::cerr << text << "\n";
}

void need_text(std::string_view option, std::string_view text, std::string_view requirement)
{
    if (text.empty())
        throw Error(ErrorKind::usage, std::string(option), std::string(requirement) + ", got \"\"");
}

}
