// workflows/completion.h -- scripts with which a shell completes the command line.
//
// Made from the options that the commands declare: names of commands, options and steps are those
// of this program, files and folders are the shell's.
#pragma once
#include <string>

namespace CLI {
class App;
}

namespace sigmaflow::workflows {

std::string bash_completion(const CLI::App& program);
std::string zsh_completion(const CLI::App& program);
std::string fish_completion(const CLI::App& program);

}
