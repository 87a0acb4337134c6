#include "workflows/help.h"

#include "workflows/steps.h"
#include "workflows/workflow.h"

#include <algorithm>

namespace sigmaflow::workflows {

namespace {

/// `words` broken into lines that begin with `indent`.
std::string paragraph(const std::string& words, const std::string& indent)
{
    constexpr std::size_t width = 96;
    std::string result = indent;
    std::size_t used = indent.size();
    for (std::size_t begin = 0; begin < words.size();) {
        std::size_t end = std::min(words.find(' ', begin), words.size());
        const std::string word = words.substr(begin, end - begin);
        if (used > indent.size() && used + 1 + word.size() > width) {
            result += "\n" + indent;
            used = indent.size();
        }
        if (used > indent.size()) {
            result += " ";
            ++used;
        }
        result += word;
        used += word.size();
        begin = end + 1;
    }
    return result + "\n";
}

std::string fields_help(const std::vector<io::Field>& fields)
{
    std::string text;
    for (const io::Field& field : fields) {
        if (!field.members.empty()) {
            text += "\n" + field.name + ": " + field.help + "\n" + fields_help(field.members);
            continue;
        }
        const bool has_unit = !field.unit.empty() && field.unit != "-";
        text += "  " + field.name + (has_unit ? " [" + field.unit + "]" : "") + ": " +
                field.allowed() + "; default: " + field.default_text() + "\n";
        text += paragraph(field.help, "      ");
    }
    return text;
}

std::string all_steps()
{
    std::string text = "steps of a workflow (sigmaflow steps STEP explains one):\n";
    for (const StepKind& kind : step_kinds()) {
        std::string name(kind.name);
        name.resize(std::max<std::size_t>(name.size() + 2, 22), ' ');
        text += "  " + name + std::string(kind.summary) + "\n";
    }
    Suspension suspension;
    io::Fields f;
    suspension.describe(f);
    return text + "\nsuspension: what all steps work on\n" + fields_help(f.list());
}

}

std::string steps_help(const std::string& name)
{
    if (name.empty()) return all_steps();
    std::vector<std::string_view> names;
    std::string known;
    for (const StepKind& kind : step_kinds()) {
        names.push_back(kind.name);
        known += (known.empty() ? "" : ", ") + std::string(kind.name);
        if (kind.name != name) continue;
        Step step = kind.make();
        return name + ": " + std::string(kind.summary) + "\n" + fields_help(step_fields(step));
    }
    const auto nearest = io::nearest_word(name, names);
    throw Error(ErrorKind::usage, "",
                "unknown step " + io::in_quotes(name) +
                    (nearest ? ", did you mean " + io::in_quotes(*nearest) + "?" : "") +
                    " (known: " + known + ")");
}

}
