// workflows/commands.h -- the commands of the program `sigmaflow`, one file each in commands/.
//
// A command declares its options at a CLI11 (sub)command and returns what is to be done if it was
// given. It prints nothing but results on stdout, and fails with an Error (its kind is the exit
// code). Help, man page and shell completion are made from the declared options.
#pragma once
#include "engine/error.h"

#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace CLI {
class App;
}

namespace sigmaflow::workflows {

using Work = std::function<void()>;

struct Command {
    std::string_view name, summary;
    std::string_view examples;  // a command line and what it does in each line
    Work (*declare)(CLI::App&);
};

std::span<const Command> commands();

Command run_command();
Command validate_command();
Command evaluate_command();
Command report_command();
Command render_command();
Command steps_command();

inline constexpr std::string_view program_summary =
    "sigmaflow: dense frictional suspensions sheared at an imposed stress";

/// Declares all commands and the help of the program. To be asked after parsing: the Work of the
/// command that was given, or none.
std::function<Work()> declare_commands(CLI::App& app);

/// "sigmaflow: error: ..." for stderr.
std::string complaint(const Error& error);

/// Prints results. Error(file) if that fails: a full disk or a closed pipe must not pass for
/// success.
void print_result(std::string_view text);

/// "must name a folder" and the like, exit code 64.
void need_text(std::string_view option, std::string_view text, std::string_view requirement);

}
