// workflows/commands.h -- the commands of the program `sigmaflow`, one file each in commands/.
//
// A command declares its options at a CLI11 (sub)command and returns what is to be done if it was
// given. It prints nothing but results on stdout, and fails with an Error (its kind is the exit
// code). Help, man page and shell completion are made from the declared options.
#pragma once
#include "engine/error.h"
#include "io/json_override.h"
#include "workflows/output.h"

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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

/// The verdict of a command that has told all on stdout already: with --json no further event.
struct Verdict : Error {
    using Error::Error;
};

std::span<const Command> commands();

Command run_command();
Command validate_command();
Command evaluate_command();
Command report_command();
Command sweep_command();
Command collect_command();
Command init_command();
Command man_command();
Command explain_command();
Command schema_command();
Command compare_command();
Command completion_command();
Command doctor_command();
Command plan_command();
Command status_command();
Command verify_command();
Command render_command();

inline constexpr std::string_view program_summary =
    "sigmaflow: dense frictional suspensions sheared at an imposed stress";

/// Declares all commands and the help of the program. To be asked after parsing: the Work of the
/// command that was given, or none.
std::function<Work()> declare_commands(CLI::App& app);

/// "sigmaflow: error: ..." for stderr.
std::string complaint(const Error& error);

/// Declares the flag --json.
void describe_json(CLI::App& app, bool& json);

/// A line on stderr for people, if that is a terminal: what to do next.
void print_hint(std::string_view text);

/// --set /steps/1/stress=3, as often as one likes; to be asked after parsing.
std::function<std::vector<io::Override>()> declare_overrides(CLI::App& app);

/// "must name a folder" and the like, exit code 64.
void need_text(std::string_view option, std::string_view text, std::string_view requirement);

}
