#include "workflows/completion.h"

#include "workflows/explain.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <vector>

namespace sigmaflow::workflows {

namespace {

enum class Words { files, folders, steps, shells };

/// What stands in the place of an argument, by the name that its help gives it.
Words words_of(const std::string& name)
{
    const std::string bare = name.substr(name.find_first_not_of('-'));
    if (bare.starts_with("STEP")) return Words::steps;
    if (bare.starts_with("SHELL")) return Words::shells;
    return bare == "DIR" || bare == "out" ? Words::folders : Words::files;
}

std::string step_names()
{
    std::string text;
    for (const std::string& name : explained_names()) text += (text.empty() ? "" : " ") + name;
    return text;
}

std::vector<const CLI::App*> commands_of(const CLI::App& program)
{
    return program.get_subcommands([](const CLI::App*) { return true; });
}

std::vector<const CLI::Option*> options_of(const CLI::App& command)
{
    std::vector<const CLI::Option*> list;
    for (const CLI::Option* option :
         command.get_options([](const CLI::Option* o) { return !o->get_positional(); }))
        list.push_back(option);
    return list;
}

/// "-q --quiet".
std::string names_of(const CLI::Option& option)
{
    std::string text;
    for (const std::string& name : option.get_snames()) text += "-" + name + " ";
    for (const std::string& name : option.get_lnames()) text += "--" + name + " ";
    if (!text.empty()) text.pop_back();
    return text;
}

bool takes_value(const CLI::Option& option)
{
    return option.get_items_expected_max() > 0;
}

std::string all_options(const CLI::App& command)
{
    std::string text;
    for (const CLI::Option* option : options_of(command))
        text += (text.empty() ? "" : " ") + names_of(*option);
    return text;
}

/// The argument of a command that is not an option, "" if there is none.
std::string positional_of(const CLI::App& command)
{
    for (const CLI::Option* option :
         command.get_options([](const CLI::Option* o) { return o->get_positional(); }))
        return option->get_name(true);
    return "";
}

/// Help in single quotes without what the shells' formats treat as special.
std::string described(std::string text)
{
    for (char& c : text)
        if (std::string_view("'[]:\\\n`$").find(c) != std::string_view::npos) c = ' ';
    constexpr std::size_t longest = 90;
    return text.size() > longest ? text.substr(0, text.rfind(' ', longest)) + " ..." : text;
}

std::string bash_words(Words words)
{
    switch (words) {
        case Words::steps:
            return "compgen -W \"" + step_names() + "\" -- \"$word\"";
        case Words::shells:
            return "compgen -W \"bash zsh fish\" -- \"$word\"";
        case Words::folders:
            return "compgen -d -- \"$word\"";
        case Words::files:
            break;
    }
    return "compgen -f -- \"$word\"";
}

std::string zsh_words(Words words)
{
    switch (words) {
        case Words::steps:
            return "(" + step_names() + ")";
        case Words::shells:
            return "(bash zsh fish)";
        case Words::folders:
            return "_files -/";
        case Words::files:
            break;
    }
    return "_files";
}

std::string fish_words(Words words)
{
    switch (words) {
        case Words::steps:
            return " -f -a '" + step_names() + "'";
        case Words::shells:
            return " -f -a 'bash zsh fish'";
        case Words::folders:
            return " -f -a '(__fish_complete_directories)'";
        case Words::files:
            break;
    }
    return " -F";
}

/// One case of a bash script: an option that takes a value, or the arguments of a command.
std::string bash_case(const std::string& pattern, const std::string& words)
{
    return "        " + pattern + ") mapfile -t COMPREPLY < <(" + words + "); return ;;\n";
}

}

std::string bash_completion(const CLI::App& program)
{
    std::string names, values, arguments;
    for (const CLI::App* command : commands_of(program)) {
        const std::string name = command->get_name();
        names += name + " ";
        for (const CLI::Option* option : options_of(*command))
            if (takes_value(*option) && !option->get_lnames().empty()) {
                const std::string written = "--" + option->get_lnames().front();
                values += bash_case(name + ":" + written, bash_words(words_of(written)));
            }
        arguments +=
            bash_case(name + ":-*", "compgen -W \"" + all_options(*command) + "\" -- \"$word\"");
        if (const std::string argument = positional_of(*command); !argument.empty())
            arguments += bash_case(name + ":*", bash_words(words_of(argument)));
    }
    return R"(# bash completion of sigmaflow: source <(sigmaflow completion bash)
_sigmaflow()
{
    local word="${COMP_WORDS[COMP_CWORD]}" before="" command="" k
    ((COMP_CWORD > 0)) && before="${COMP_WORDS[COMP_CWORD-1]}"
    for ((k = 1; k < COMP_CWORD; ++k)); do
        if [[ "${COMP_WORDS[k]}" != -* ]]; then command="${COMP_WORDS[k]}"; break; fi
    done
    COMPREPLY=()
    if [[ -z "$command" ]]; then
        mapfile -t COMPREPLY < <(compgen -W ")" +
           names + all_options(program) + R"(" -- "$word")
        return
    fi
    case "$command:$before" in
)" + values +
           R"(    esac
    case "$command:$word" in
)" + arguments +
           R"(    esac
}
complete -o filenames -F _sigmaflow sigmaflow
)";
}

std::string zsh_completion(const CLI::App& program)
{
    std::string names, cases;
    for (const CLI::App* command : commands_of(program)) {
        names +=
            "    '" + command->get_name() + ":" + described(command->get_description()) + "'\n";
        cases += "    " + command->get_name() + ")\n      _arguments";
        for (const CLI::Option* option : options_of(*command))
            for (const std::string& name : option->get_lnames()) {
                cases +=
                    " \\\n        '--" + name + "[" + described(option->get_description()) + "]";
                if (takes_value(*option)) cases += ":value:" + zsh_words(words_of("--" + name));
                cases += "'";
            }
        if (const std::string argument = positional_of(*command); !argument.empty())
            cases += " \\\n        '*:argument:" + zsh_words(words_of(argument)) + "'";
        cases += " ;;\n";
    }
    return R"(#compdef sigmaflow
# zsh completion of sigmaflow: sigmaflow completion zsh > "${fpath[1]}/_sigmaflow"
_sigmaflow() {
  local -a commands
  commands=(
)" + names +
           R"(  )
  if (( CURRENT == 2 )); then
    _describe command commands
    return
  fi
  local command=$words[2]
  shift words
  (( CURRENT-- ))
  case $command in
)" + cases +
           R"(  esac
}
if [ "$funcstack[1]" = "_sigmaflow" ]; then _sigmaflow "$@"; else compdef _sigmaflow sigmaflow; fi
)";
}

std::string fish_completion(const CLI::App& program)
{
    std::string text = "# fish completion of sigmaflow: sigmaflow completion fish | source\n";
    for (const CLI::App* command : commands_of(program)) {
        const std::string name = command->get_name();
        text += "complete -c sigmaflow -f -n __fish_use_subcommand -a " + name + " -d '" +
                described(command->get_description()) + "'\n";
        const std::string seen =
            "complete -c sigmaflow -n '__fish_seen_subcommand_from " + name + "'";
        for (const CLI::Option* option : options_of(*command))
            for (const std::string& word : option->get_lnames())
                text += seen + " -l " + word +
                        (takes_value(*option) ? " -r" + fish_words(words_of("--" + word)) : "") +
                        " -d '" + described(option->get_description()) + "'\n";
        if (const std::string argument = positional_of(*command); !argument.empty())
            text += seen + fish_words(words_of(argument)) + "\n";
    }
    return text;
}

}
