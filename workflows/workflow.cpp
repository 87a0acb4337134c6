#include "workflows/workflow.h"

#include "workflows/steps.h"

#include <algorithm>
#include <set>

namespace sigmaflow::workflows {

void Plan::need_state(const io::JsonNode& step) const
{
    if (!has_state) throw step.error("needs particles: put a step \"pack\" before it");
}

const PlannedRun& Plan::need_run(const io::JsonNode& step, std::string& of, bool with_frames) const
{
    const auto usable = [&](const PlannedRun& run) { return run.frames > 0 || !with_frames; };
    const std::string wanted = with_frames ? "\"shear\"" : "\"shear\" or \"equilibrate\"";
    if (of.empty()) {
        const auto last = std::find_if(runs.rbegin(), runs.rend(), usable);
        if (last == runs.rend())
            throw step.error("needs a run: put a step " + wanted + " before it");
        of = last->name;
        return *last;
    }
    std::vector<std::string_view> names;
    for (const PlannedRun& run : runs)
        if (usable(run)) names.push_back(run.name);
    if (names.empty()) throw step.error("needs a run: put a step " + wanted + " before it");
    const std::size_t index = step.member("of").word(names);
    return *std::find_if(runs.begin(), runs.end(),
                         [&](const PlannedRun& run) { return run.name == names[index]; });
}

const Run& Context::run(const std::string& name) const
{
    const auto it =
        std::find_if(runs.begin(), runs.end(), [&](const Run& run) { return run.name == name; });
    if (it == runs.end()) throw Error(ErrorKind::internal, name, "run does not exist");
    return *it;
}

namespace {

constexpr std::size_t most_steps = 1000, longest_name = 64;

bool is_name(const std::string& text)
{
    const auto good = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               c == '_' || c == '-';
    };
    return !text.empty() && text.size() <= longest_name && text[0] != '-' &&
           std::all_of(text.begin(), text.end(), good);
}

Step make_step(const io::JsonNode& node)
{
    std::vector<std::string_view> names;
    for (const StepKind& kind : step_kinds()) names.push_back(kind.name);
    Step step = step_kinds()[node.member("step").word(names)].make();
    step.pointer = node.pointer();
    return step;
}

/// Steps are named after their kind, the second one of a kind "<kind>_2" and so on, unless named.
void name_steps(std::vector<Step>& steps, const std::vector<io::JsonNode>& nodes)
{
    std::set<std::string> used;
    for (const io::JsonNode& node : nodes) {
        const auto given = node.find("name");
        if (!given) continue;
        const std::string name = given->text();
        if (!is_name(name))
            throw given->wrong("must be 1 to 64 letters, digits, _ or -, not beginning with -");
        if (!used.insert(name).second) throw given->wrong("must be different for every step");
    }
    for (std::size_t i = 0; i < steps.size(); ++i) {
        if (const auto given = nodes[i].find("name")) {
            steps[i].name = given->text();
            continue;
        }
        const std::string kind = steps[i].kind;
        for (int number = 2; !used.insert(steps[i].name).second; ++number)
            steps[i].name = kind + "_" + std::to_string(number);
    }
}

std::vector<io::Field> workflow_fields(Workflow& workflow, std::string& schema)
{
    io::Fields f;
    f("$schema", schema, 4096, "address of the schema, for editors; not used");
    f("name", workflow.name, 200, "title of the workflow; default: the name of the file");
    f("description", workflow.description, 100'000, "free text; not used");
    f.group("suspension", "the suspension that all steps work on",
            [&](io::Fields& inner) { workflow.suspension->describe(inner); });
    return f.list();
}

Workflow checked_workflow(const io::JsonDocument& document, const std::string& default_name)
{
    const io::JsonNode root = document.root();
    Workflow workflow;
    workflow.suspension = std::make_unique<Suspension>();
    std::string schema;
    root.refuse_other_keys({"$schema", "name", "description", "suspension", "steps"});
    for (const io::Field& field : workflow_fields(workflow, schema))
        if (const auto node = root.find(field.name)) field.read(*node);
    if (workflow.name.empty()) workflow.name = default_name;
    workflow.suspension->check(root.member("suspension"));

    const std::vector<io::JsonNode> nodes = root.member("steps").elements({1, most_steps});
    for (const io::JsonNode& node : nodes) workflow.steps.push_back(make_step(node));
    name_steps(workflow.steps, nodes);
    Plan plan{.suspension = *workflow.suspension,
              .step_name = "",
              .has_state = false,
              .volume_fraction = 0,
              .changes_state = false,
              .needs = {},
              .runs = {}};
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        Step& step = workflow.steps[i];
        io::read_fields(nodes[i], step_fields(step));
        plan.step_name = step.name;
        plan.changes_state = false;
        plan.needs = {};
        step.validate(nodes[i], plan);
        step.changes_state = plan.changes_state;
        step.needs = plan.needs;
    }
    return workflow;
}

}

std::vector<io::Field> step_fields(Step& step)
{
    io::Fields f;
    f("step", step.kind, std::vector<std::string_view>{step.kind}, "kind of the step").require();
    f("name", step.name, longest_name, "name of its files; default: the kind, then kind_2, ...");
    step.describe(f);
    return f.list();
}

Workflow read_workflow(const std::filesystem::path& path)
{
    return read_workflow(io::JsonDocument::read(path), path);
}

Workflow read_workflow(const io::JsonDocument& document, const std::filesystem::path& path)
{
    return checked_workflow(document, path.stem().string());
}

Workflow parse_workflow(const std::string& text, const std::string& file)
{
    return checked_workflow(io::JsonDocument::parse(text, file),
                            std::filesystem::path(file).stem().string());
}

nlohmann::ordered_json Workflow::resolved() const
{
    nlohmann::ordered_json result;
    result["name"] = name;
    if (!description.empty()) result["description"] = description;
    io::Fields f;
    suspension->describe(f);
    auto& written = result["suspension"] = io::write_fields(f.list());
    if (!suspension->packing.radii.empty()) {  // these exclude each other
        written.erase("size_ratio");
        written.erase("small_volume_share");
    }
    auto& list = result["steps"] = nlohmann::ordered_json::array();
    for (const Step& step : steps) {
        Step copy = step;  // the same parameters behind it
        list.push_back(io::write_fields(step_fields(copy)));
    }
    return result;
}

}
