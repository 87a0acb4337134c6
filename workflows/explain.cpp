#include "workflows/explain.h"

#include "workflows/schema.h"
#include "workflows/step_names.h"
#include "workflows/steps.h"
#include "workflows/workflow.h"

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

namespace sigmaflow::workflows {

namespace {

/// An object of a workflow file.
struct Topic {
    std::string name, summary;
    std::vector<io::Field> fields;
    std::shared_ptr<void> described = {};  // what the fields refer to
};

Topic workflow_topic()
{
    const auto workflow = std::make_shared<Workflow>();
    workflow->suspension = std::make_unique<Suspension>();
    std::string schema;
    std::vector<io::Field> fields = workflow_fields(*workflow, schema);
    fields.erase(fields.begin());  // "$schema", whose place is not kept
    fields.push_back({.name = "steps",
                      .help = "what is done, one after the other: objects with a \"step\"",
                      .kind = io::FieldKind::objects,
                      .elements = {1, most_steps},
                      .required = true});
    return {"workflow", "the file", std::move(fields), workflow};
}

Topic step_topic(const StepKind& kind)
{
    const auto step = std::make_shared<Step>(kind.make());
    return {std::string(kind.name), std::string(kind.summary), step_fields(*step), step};
}

const io::Field& member(const std::vector<io::Field>& fields, std::string_view name)
{
    return *std::find_if(fields.begin(), fields.end(),
                         [&](const io::Field& field) { return field.name == name; });
}

/// The file first, then what is inside it.
std::vector<Topic> topics()
{
    std::vector<Topic> list{workflow_topic()};
    const auto inside = [&](const char* name, const io::Field& group) {
        list.push_back({name, group.help, group.members, list.front().described});
    };
    inside("suspension", member(list.front().fields, "suspension"));
    inside("model", member(list.back().fields, "model"));
    for (const StepKind& kind : step_kinds()) list.push_back(step_topic(kind));
    return list;
}

/// `words` broken into lines that begin with `indent`.
std::string paragraph(const std::string& words, const std::string& indent)
{
    constexpr std::size_t width = 96;
    std::string result = indent;
    std::size_t used = indent.size();
    for (std::size_t begin = 0; begin < words.size();) {
        const std::size_t end = std::min(words.find(' ', begin), words.size());
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

/// Explained apart.
bool is_topic(const io::Field& field)
{
    return field.kind == io::FieldKind::group &&
           (field.name == "model" || field.name == "suspension");
}

bool has_unit(const io::Field& field)
{
    return !field.unit.empty() && field.unit != "-";
}

std::string field_line(const std::string& name, const io::Field& field)
{
    return "  " + name + (has_unit(field) ? " [" + field.unit + "]" : "") + ": " + field.allowed() +
           "; default: " + field.default_text() + "\n" + paragraph(field.help, "      ");
}

std::string fields_text(const std::vector<io::Field>& fields)
{
    std::string text;
    for (const io::Field& field : fields)
        if (is_topic(field))
            text += "  " + field.name + ": object (sigmaflow explain " + field.name + ")\n" +
                    paragraph(field.help, "      ");
        else if (field.kind == io::FieldKind::group)
            text += "\n" + field.name + ": " + field.help + "\n" + fields_text(field.members);
        else
            text += field_line(field.name, field);
    return text;
}

std::string padded(std::string text, std::size_t width)
{
    text.resize(std::max(text.size() + 2, width), ' ');
    return text;
}

std::string overview(const std::vector<Topic>& list)
{
    std::string text =
        "what a workflow file can say (sigmaflow explain STEP, explain STEP.PARAMETER):\n\n";
    for (std::size_t k = 0; k < 3; ++k)
        text += "  " + padded(list[k].name, 22) + list[k].summary + "\n";
    text += "\nsteps:\n";
    for (std::size_t k = 3; k < list.size(); ++k)
        text += "  " + padded(list[k].name, 22) + list[k].summary + "\n";
    return text;
}

std::string topic_text(const Topic& topic)
{
    return topic.name + ": " + topic.summary + "\n" + fields_text(topic.fields);
}

/// The fields of a topic and of the groups in it but the model, which is a topic itself, named
/// "topic.field" and "topic.group.field".
void visit(const std::string& path, const std::vector<io::Field>& fields,
           const std::function<void(const std::string&, const io::Field&)>& see)
{
    for (const io::Field& field : fields) {
        const std::string name = path + "." + field.name;
        see(name, field);
        if (field.kind == io::FieldKind::group && !is_topic(field)) visit(name, field.members, see);
    }
}

std::string escaped(const std::string& text)
{
    std::string result;
    for (char c : text)
        result += c == '|' || c == '<' || c == '*' ? std::string{'\\', c} : std::string{c};
    return result;
}

void add_rows(const std::string& prefix, const std::vector<io::Field>& fields, std::string& text)
{
    for (const io::Field& field : fields) {
        const bool link = is_topic(field);
        text +=
            "| `" + prefix + field.name + "` | " + (has_unit(field) ? escaped(field.unit) : "") +
            " | " + (link ? "[object](#" + field.name + ")" : escaped(field.allowed())) + " | " +
            (link ? "" : "`" + field.default_text() + "`") + " | " + escaped(field.help) + " |\n";
        if (field.kind == io::FieldKind::group && !link)
            add_rows(prefix + field.name + ".", field.members, text);
    }
}

}

std::string explain(const std::string& what)
{
    const std::vector<Topic> list = topics();
    if (what.empty()) return overview(list);
    std::string found;
    std::vector<std::string> names;
    for (const Topic& topic : list) {
        if (topic.name == what) return topic_text(topic);
        names.push_back(topic.name);
        visit(topic.name, topic.fields, [&](const std::string& path, const io::Field& field) {
            names.push_back(path);
            names.push_back(field.name);
            const bool through_model =
                field.name == "model" && what.starts_with(path + ".");  // shear.model.friction...
            if (path == what || field.name == what)
                found += field_line(path, field);
            else if (through_model)
                for (const io::Field& inner : field.members)
                    if (path + "." + inner.name == what) found += field_line(what, inner);
        });
    }
    if (!found.empty()) return found;
    const std::vector<std::string_view> known(names.begin(), names.end());
    const auto nearest = io::nearest_word(what, known);
    throw Error(ErrorKind::usage, "",
                "unknown step or parameter " + io::in_quotes(what) +
                    (nearest ? ", did you mean " + io::in_quotes(*nearest) + "?" : "") +
                    " (sigmaflow explain lists the steps)");
}

std::string reference_page()
{
    std::string text =
        "# What a workflow file can say\n\n"
        "Made by `sigmaflow explain --markdown`; `sigmaflow explain STEP.PARAMETER` tells the same "
        "in the terminal,\nand an editor that knows [the schema](" +
        std::string(schema_name) + ") while you type.\n";
    for (const Topic& topic : topics()) {
        text += "\n## " + topic.name + "\n\n" + escaped(topic.summary) +
                "\n\n| parameter | unit | allowed | default | meaning |\n"
                "| --- | --- | --- | --- | --- |\n";
        add_rows("", topic.fields, text);
    }
    return text;
}

std::vector<std::string> explained_names()
{
    std::vector<std::string> names;
    for (const Topic& topic : topics()) {
        names.push_back(topic.name);
        visit(topic.name, topic.fields,
              [&](const std::string& path, const io::Field&) { names.push_back(path); });
    }
    return names;
}

}
