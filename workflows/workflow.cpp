#include "workflows/workflow.h"

#include "io/problems.h"
#include "workflows/step_names.h"
#include "workflows/steps.h"

#include <algorithm>
#include <array>

namespace sigmaflow::workflows {

using Json = nlohmann::ordered_json;

namespace {

Step make_step(const io::JsonNode& node)
{
    std::vector<std::string_view> names;
    for (const StepKind& kind : step_kinds()) names.push_back(kind.name);
    Step step = step_kinds()[node.member("step").word(names)].make();
    step.pointer = node.pointer();
    return step;
}

void read_step(Step& step, const StepText& text)
{
    std::vector<io::Field> fields = step_fields(step);
    const std::string name = step.name;  // given names are those of the file
    const auto swept = std::find_if(fields.begin(), fields.end(),
                                    [&](const auto& field) { return field.name == text.swept; });
    if (swept != fields.end()) swept->required = false;  // it has a value
    io::Problems problems;
    problems.collect([&] { io::read_fields(text.node, fields); });
    step.name = name;
    if (text.value)
        problems.collect([&] {
            const std::vector<io::Field>& can_be_swept = fields.back().members;
            std::vector<std::string_view> known;
            for (const io::Field& field : can_be_swept) {
                known.push_back(field.name);
                if (field.name == text.swept) return field.read(*text.value);
            }
            const io::JsonNode sweep = text.node.member("sweep");
            if (swept != fields.end())
                throw sweep.error("cannot be of " + io::in_quotes(text.swept));
            sweep.refuse_other_keys(known);
        });
    problems.throw_all();
}

/// Then the suspension is that of the run.
bool begins_with_a_stored_run(const io::JsonNode& workflow)
{
    const auto steps = workflow.find("steps");
    if (!steps || !steps->is_array() || steps->size() == 0) return false;
    const io::JsonNode first = steps->element(0);
    return first.is_object() && first.has("step") && first.member("step").is_text() &&
           first.member("step").text() == "stored_run";
}

/// Steps of the file that cannot be read have no name and no kind, but a place.
std::vector<StepText> step_texts(const io::JsonNode& root, io::Problems& problems)
{
    std::vector<StepText> texts;
    const auto unfold = [&](const io::JsonNode& node) {
        for (const StepText& text : unfolded(node)) texts.push_back(text);
    };
    for (const io::JsonNode& node : root.member("steps").elements({1, most_steps})) {
        if (!problems.collect([&] { unfold(node); })) texts.push_back({node});
        if (texts.size() > most_steps)
            throw root.member("steps").error("stands for more than " + std::to_string(most_steps) +
                                             " steps");
    }
    return texts;
}

/// What the step asks of the machine and of other steps.
void validate_step(Step& step, const io::JsonNode& node, Plan& plan)
{
    plan.changes_state = false;
    plan.inputs.clear();
    plan.needs = {};
    plan.uses = {};
    plan.endings = {};
    step.validate(node, plan);
    step.changes_state = plan.changes_state;
    step.inputs = plan.inputs;
    if (plan.needs.particles == 0) plan.needs.particles = plan.particles;
    step.needs = plan.needs;
    step.uses = plan.uses;
    if (step.needs.draws() && plan.endings.empty()) plan.endings = {""};
    for (const std::string& ending : plan.endings)
        plan.pictures.push_back({step.name + ending, step.name});
}

void read_steps(const io::JsonNode& root, Plan plan, std::vector<Step>& steps,
                io::Problems& problems)
{
    const std::vector<StepText> texts = step_texts(root, problems);
    std::vector<bool> sound;
    for (const StepText& text : texts) {
        steps.emplace_back();
        sound.push_back(problems.collect([&] { steps.back() = make_step(text.node); }));
    }
    name_steps(steps, texts, problems);
    for (std::size_t i = 0; i < texts.size(); ++i) {
        Step& step = steps[i];
        plan.step_name = step.name;
        if (!sound[i] || !problems.collect([&] {
                read_step(step, texts[i]);
                validate_step(step, texts[i].node, plan);
            }))
            plan.assume_results();
    }
}

Workflow checked_workflow(const io::JsonDocument& document, const std::filesystem::path& path)
{
    const io::JsonNode root = document.root();
    if (!root.is_object()) throw root.wrong("must be an object");
    Workflow workflow;
    workflow.suspension = std::make_unique<Suspension>();
    Suspension& suspension = *workflow.suspension;
    io::Problems problems;
    std::string schema;
    constexpr std::array<std::string_view, 5> known{"$schema", "name", "description", "suspension",
                                                    "steps"};
    problems.collect([&] { root.refuse_other_keys(known); });
    const auto read_suspension = [&](const io::Field& field) {
        if (const auto node = root.find(field.name)) field.read(*node);
        if (root.has("suspension") ||
            (!begins_with_a_stored_run(root) && !root.misspells("suspension", known)))
            suspension.check(root.member("suspension"), path.parent_path());
    };
    for (const io::Field& field : workflow_fields(workflow, schema)) {
        if (field.name != "suspension") {
            problems.collect([&] {
                if (const auto node = root.find(field.name)) field.read(*node);
            });
        } else if (!problems.collect([&] { read_suspension(field); })) {
            suspension = {};  // steps are checked with that of the defaults
            suspension.largest_volume_fraction = 1;
        }
    }
    if (workflow.name.empty()) workflow.name = path.stem().string();
    Plan plan{.suspension = suspension,
              .has_suspension = root.has("suspension") || !begins_with_a_stored_run(root),
              .folder = path.parent_path(),
              .step_name = "",
              .has_state = false,
              .particles = 0,
              .volume_fraction = 0,
              .narrowest_box = 0,
              .largest_radius = 0,
              .changes_state = false,
              .inputs = {},
              .needs = {},
              .uses = {},
              .endings = {},
              .runs = {},
              .pictures = {},
              .responses = {}};
    if (!root.misspells("steps", known))
        problems.collect([&] { read_steps(root, std::move(plan), workflow.steps, problems); });
    problems.throw_all();
    return workflow;
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

std::vector<io::Field> step_fields(Step& step)
{
    io::Fields f;
    f("step", step.kind, std::vector<std::string_view>{step.kind}, "kind of the step").require();
    io::Field& name = f("name", step.name, longest_name,
                        "name of its files; default: the kind, then kind_2, ...");
    name.pattern = name_pattern;
    name.read = [&step](const io::JsonNode& node) {
        if (!is_name(node.text())) throw node.wrong(name_rule);
        step.name = node.text();
    };
    step.describe(f);
    std::vector<io::Field> list = f.list();
    list.push_back(comment_field());
    list.push_back({.name = "sweep",
                    .help =
                        "{\"stress\": [0.5, 1, 2]}: this step once for each value of one of its "
                        "parameters, one after the other, named \"<name>_0.5\" and so on",
                    .kind = io::FieldKind::sweep,
                    .members = std::vector<io::Field>(list.begin() + 2, list.end() - 1),
                    .read = [](const io::JsonNode&) {},  // unfolded before
                    .write = [] { return nlohmann::ordered_json(); }});
    return list;
}

Workflow read_workflow(const std::filesystem::path& path)
{
    return read_workflow(io::JsonDocument::read(path), path);
}

Workflow read_workflow(const io::JsonDocument& document, const std::filesystem::path& path)
{
    return checked_workflow(document, path);
}

Workflow parse_workflow(const std::string& text, const std::string& file)
{
    return checked_workflow(io::JsonDocument::parse(text, file), file);
}

std::vector<std::string> Workflow::step_names() const
{
    std::vector<std::string> names;
    for (const Step& step : steps) names.push_back(step.name);
    return names;
}

namespace {

/// All parameters; `written` may change those of a step.
Json written_workflow(const Workflow& workflow,
                      const std::function<void(const std::vector<io::Field>&, Json&)>& written)
{
    Json result;
    result["name"] = workflow.name;
    if (!workflow.description.empty()) result["description"] = workflow.description;
    io::Fields f;
    workflow.suspension->describe(f);
    Json& suspension = result["suspension"] = io::write_fields(f.list());
    suspension.erase("radii_file");                     // its numbers are among the radii
    if (!workflow.suspension->packing.radii.empty()) {  // these exclude each other
        suspension.erase("size_ratio");
        suspension.erase("small_volume_share");
    }
    if (!workflow.steps.empty() && workflow.steps.front().kind == "stored_state") {
        // the file says them
        if (!workflow.suspension->says_particles) suspension.erase("particles");
        if (!workflow.suspension->says_volume_fraction) suspension.erase("volume_fraction");
    }
    Json& list = result["steps"] = Json::array();
    for (const Step& step : workflow.steps) {
        Step copy = step;  // the same parameters behind it
        const std::vector<io::Field> fields = step_fields(copy);
        list.push_back(io::write_fields(fields));
        written(fields, list.back());
    }
    return result;
}

}

Json Workflow::resolved() const
{
    return written_workflow(*this, [](const auto&, Json&) {});
}

Json Workflow::standing_alone(const std::filesystem::path& folder) const
{
    const std::filesystem::path from = std::filesystem::current_path() / folder;
    return written_workflow(*this, [&](const std::vector<io::Field>& fields, Json& step) {
        for (const io::Field& field : fields)
            if (field.names_file && step.contains(field.name))
                step[field.name] =
                    (from / step[field.name].get<std::string>()).lexically_normal().string();
    });
}

}
