#include "workflows/man_page.h"

#include "workflows/commands.h"
#include "workflows/manifest.h"

#include <CLI/CLI.hpp>

namespace sigmaflow::workflows {

namespace {

/// Text as man(7) wants it: no line begins with a control character, no minus is a hyphen.
std::string plain(const std::string& text)
{
    std::string result;
    bool line_begins = true;
    for (char c : text) {
        if (line_begins && (c == '.' || c == '\'')) result += "\\&";
        if (c == '\\')
            result += "\\e";
        else if (c == '-')
            result += "\\-";
        else
            result += c;
        line_begins = c == '\n';
    }
    return result;
}

std::string as_is(const std::string& text)
{
    return ".nf\n" + plain(text) + "\n.fi\n";
}

std::string option_text(const CLI::Option& option)
{
    const bool takes_value = option.get_items_expected_max() > 0;
    std::string text = ".TP\n.B " + plain(option.get_name(false, true));
    if (takes_value && !option.get_positional()) text += " \\fIVALUE\\fR";
    text += "\n" + plain(option.get_description());
    if (!option.get_default_str().empty())
        text += " (default " + plain(option.get_default_str()) + ")";
    return text + "\n";
}

std::string command_text(const CLI::App& command, const Command& declared)
{
    std::string text =
        ".SS " + plain(command.get_name()) + "\n" + plain(command.get_description()) + ".\n";
    for (const CLI::Option* option : command.get_options())
        if (option->get_name() != "--help") text += option_text(*option);
    return text + ".PP\n" + as_is(std::string(declared.examples));
}

}

std::string man_page(const CLI::App& app)
{
    std::string text = ".TH SIGMAFLOW 1 \"\" \"sigmaflow " + version() +
                       "\" \"User commands\"\n"
                       ".SH NAME\nsigmaflow \\- dense frictional suspensions sheared at an imposed "
                       "stress\n"
                       ".SH SYNOPSIS\n.B sigmaflow\n\\fICOMMAND\\fR [\\fIOPTIONS\\fR] ...\n"
                       ".SH DESCRIPTION\n" +
                       plain(
                           "Shears spheres with lubrication, friction and repulsion in Stokes "
                           "flow at an imposed shear stress, as a JSON workflow file says, and "
                           "writes numbers with error bars, pictures and ParaView files.\n");
    text += ".SH COMMANDS\n";
    for (const Command& command : commands())
        text += command_text(*app.get_subcommand(std::string(command.name)), command);
    text += ".SH EXAMPLES AND EXIT CODES\n" + as_is(app.get_footer());
    text += ".SH SEE ALSO\n" + plain("sigmaflow explain tells all steps and parameters.\n");
    return text;
}

}
