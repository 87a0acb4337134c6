// sigmaflow completion
#include "workflows/completion.h"

#include "workflows/commands.h"

#include <CLI/CLI.hpp>
#include <memory>

namespace sigmaflow::workflows {

namespace {

Work declare(CLI::App& app)
{
    const auto shell = std::make_shared<std::string>();
    app.add_option("SHELL", *shell, "bash, zsh or fish")
        ->required()
        ->check(CLI::IsMember({"bash", "zsh", "fish"}));
    return [shell, &app] {
        const CLI::App& program = *app.get_parent();
        print_result(*shell == "bash"  ? bash_completion(program)
                     : *shell == "zsh" ? zsh_completion(program)
                                       : fish_completion(program));
    };
}

}

Command completion_command()
{
    return {
        "completion", "a script with which a shell completes this command line",
        R"(  source <(sigmaflow completion bash)                 in this bash; in ~/.bashrc: in every one
  sigmaflow completion zsh > "${fpath[1]}/_sigmaflow"
  sigmaflow completion fish | source)",
        declare};
}

}
