#include "workflows/workflow.h"

#include "workflows/steps.h"

#include <algorithm>
#include <set>

namespace sigmaflow::workflows {

void Plan::need_state(const io::JsonNode& step) const
{
    if (!has_state) throw step.error("needs particles: put a step \"pack\" before it");
}

void Plan::need_suspension(const io::JsonNode& step) const
{
    if (!has_suspension)
        throw step.error("needs a \"suspension\" in the workflow: only stored runs do without");
}

PlannedRun Plan::shears(const Control& control, double strain, double frames) const
{
    return {.name = step_name,
            .control = control,
            .particles = particles,
            .volume_fraction = volume_fraction,
            .narrowest_box = narrowest_box,
            .largest_radius = largest_radius,
            .strain = strain,
            .frames = frames};
}

const PlannedRun& Plan::need_run(const io::JsonNode& step, std::string& of, bool with_frames)
{
    const auto found = [&](const PlannedRun& run) -> const PlannedRun& {
        needs.particles = run.particles;
        uses.push_back(run.name);
        if (with_frames) needs.frames_read = run.frames;
        return run;
    };
    const auto usable = [&](const PlannedRun& run) { return run.frames > 0 || !with_frames; };
    const std::string wanted = with_frames ? "\"shear\"" : "\"shear\" or \"equilibrate\"";
    if (of.empty()) {
        const auto last = std::find_if(runs.rbegin(), runs.rend(), usable);
        if (last == runs.rend())
            throw step.error("needs a run: put a step " + wanted + " before it");
        of = last->name;
        return found(*last);
    }
    std::vector<std::string_view> names;
    for (const PlannedRun& run : runs)
        if (usable(run)) names.push_back(run.name);
    if (names.empty()) throw step.error("needs a run: put a step " + wanted + " before it");
    const std::size_t index = step.member("of").word(names);
    return found(*std::find_if(runs.begin(), runs.end(),
                               [&](const PlannedRun& run) { return run.name == names[index]; }));
}

void check_within(const PlannedRun& run, const io::JsonNode& step, const char* key,
                  const std::optional<double>& strain)
{
    if (strain && *strain > run.strain)
        throw step.member(key).wrong("must be <= " + io::number_text(run.strain) +
                                     ", the strain of " + io::in_quotes(run.name));
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

bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

bool is_name(const std::string& text)
{
    if (text.empty() || text.size() > longest_name || text[0] == '-') return false;
    for (std::size_t k = 0; k < text.size(); ++k) {
        const char c = text[k];
        // a point in a number: no name is that of a file
        const bool decimal = c == '.' && k > 0 && k + 1 < text.size() && is_digit(text[k - 1]) &&
                             is_digit(text[k + 1]);
        const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
        if (!letter && !is_digit(c) && c != '_' && c != '-' && !decimal) return false;
    }
    return true;
}

/// What a step of the file says, or one of the steps that it stands for with a "sweep".
struct StepText {
    io::JsonNode node;
    std::string swept = {};                  // name of the parameter
    std::optional<io::JsonNode> value = {};  // of it
};

std::vector<StepText> unfolded(const io::JsonNode& node)
{
    const auto sweep = node.find("sweep");
    if (!sweep) return {{node}};
    const std::vector<std::string> names = sweep->keys();
    if (names.size() != 1)
        throw sweep->error(
            "must have one parameter with a list of values, as {\"stress\": [1, 2]}");
    if (node.has(names.front())) throw node.error_at_key(names.front(), "is in the sweep as well");
    std::vector<StepText> result;
    for (const io::JsonNode& value : sweep->member(names.front()).elements({1, most_steps}))
        result.push_back({node, names.front(), value});
    return result;
}

Step make_step(const io::JsonNode& node)
{
    std::vector<std::string_view> names;
    for (const StepKind& kind : step_kinds()) names.push_back(kind.name);
    Step step = step_kinds()[node.member("step").word(names)].make();
    step.pointer = node.pointer();
    return step;
}

/// Steps are named after their kind, the second one of a kind "<kind>_2" and so on, unless named;
/// those of a sweep after the value, too: "<name>_0.5".
void name_steps(std::vector<Step>& steps, const std::vector<StepText>& texts)
{
    std::set<std::string> used;
    const auto base = [&](std::size_t i) {
        const auto given = texts[i].node.find("name");
        return given ? given->text() : steps[i].kind;
    };
    const auto with_value = [&](std::size_t i) {
        return base(i) + "_" +
               (texts[i].value->is_number() ? texts[i].value->shown() : texts[i].value->text());
    };
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const auto given = texts[i].node.find("name");
        if (!given && !texts[i].value) continue;
        steps[i].name = texts[i].value ? with_value(i) : base(i);
        if (given && !is_name(base(i)))
            throw given->wrong("must be 1 to 64 letters, digits, _ or -, not beginning with -");
        if (!is_name(steps[i].name))
            throw texts[i].value->wrong(
                "must be a number or a word that can be a part of the name of the step");
        if (!used.insert(steps[i].name).second)
            throw(texts[i].value ? *texts[i].value : *given)
                .wrong("must be different for every step");
    }
    for (std::size_t i = 0; i < steps.size(); ++i) {
        if (texts[i].value || texts[i].node.has("name")) continue;
        const std::string kind = steps[i].kind;
        for (int number = 2; !used.insert(steps[i].name).second; ++number)
            steps[i].name = kind + "_" + std::to_string(number);
    }
}

void read_step(Step& step, const StepText& text)
{
    const std::vector<io::Field> fields = step_fields(step);
    const std::string name = step.name;  // given names are those of the file
    io::read_fields(text.node, fields);
    step.name = name;
    if (!text.value) return;
    std::vector<std::string_view> known;
    for (const io::Field& field : fields) {
        known.push_back(field.name);
        if (field.name != text.swept || field.name == "step" || field.name == "name") continue;
        field.read(*text.value);
        return;
    }
    text.node.member("sweep").refuse_other_keys(known);
    throw text.node.member("sweep").error("cannot be of " + io::in_quotes(text.swept));
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

/// Then the suspension is that of the run.
bool begins_with_a_stored_run(const io::JsonNode& workflow)
{
    const auto steps = workflow.find("steps");
    if (!steps || !steps->is_array() || steps->size() == 0) return false;
    const io::JsonNode first = steps->element(0);
    return first.is_object() && first.has("step") && first.member("step").is_text() &&
           first.member("step").text() == "stored_run";
}

Workflow checked_workflow(const io::JsonDocument& document, const std::filesystem::path& path)
{
    const io::JsonNode root = document.root();
    Workflow workflow;
    workflow.suspension = std::make_unique<Suspension>();
    std::string schema;
    root.refuse_other_keys({"$schema", "name", "description", "suspension", "steps"});
    for (const io::Field& field : workflow_fields(workflow, schema))
        if (const auto node = root.find(field.name)) field.read(*node);
    if (workflow.name.empty()) workflow.name = path.stem().string();
    if (root.has("suspension") || !begins_with_a_stored_run(root))
        workflow.suspension->check(root.member("suspension"), path.parent_path());

    std::vector<StepText> texts;
    for (const io::JsonNode& node : root.member("steps").elements({1, most_steps}))
        for (const StepText& text : unfolded(node)) {
            texts.push_back(text);
            if (texts.size() > most_steps)
                throw root.member("steps").error("stands for more than " +
                                                 std::to_string(most_steps) + " steps");
        }
    for (const StepText& text : texts) workflow.steps.push_back(make_step(text.node));
    name_steps(workflow.steps, texts);
    Plan plan{.suspension = *workflow.suspension,
              .has_suspension = root.has("suspension"),
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
    for (std::size_t i = 0; i < texts.size(); ++i) {
        Step& step = workflow.steps[i];
        read_step(step, texts[i]);
        plan.step_name = step.name;
        plan.changes_state = false;
        plan.inputs.clear();
        plan.needs = {};
        plan.uses = {};
        plan.endings = {};
        step.validate(texts[i].node, plan);
        step.changes_state = plan.changes_state;
        step.inputs = plan.inputs;
        if (plan.needs.particles == 0) plan.needs.particles = plan.particles;
        step.needs = plan.needs;
        step.uses = plan.uses;
        if (step.needs.draws() && plan.endings.empty()) plan.endings = {""};
        for (const std::string& ending : plan.endings)
            plan.pictures.push_back({step.name + ending, step.name});
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
    std::vector<io::Field> list = f.list();
    list.push_back({.name = "sweep",
                    .help =
                        "{\"stress\": [0.5, 1, 2]}: this step once for each value of one of its "
                        "parameters, one after the other, named \"<name>_0.5\" and so on",
                    .kind = io::FieldKind::group,
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

nlohmann::ordered_json Workflow::resolved() const
{
    nlohmann::ordered_json result;
    result["name"] = name;
    if (!description.empty()) result["description"] = description;
    io::Fields f;
    suspension->describe(f);
    auto& written = result["suspension"] = io::write_fields(f.list());
    written.erase("radii_file");               // its numbers are among the radii
    if (!suspension->packing.radii.empty()) {  // these exclude each other
        written.erase("size_ratio");
        written.erase("small_volume_share");
    }
    if (!steps.empty() && steps.front().kind == "stored_state") {  // the file says them
        if (!suspension->says_particles) written.erase("particles");
        if (!suspension->says_volume_fraction) written.erase("volume_fraction");
    }
    auto& list = result["steps"] = nlohmann::ordered_json::array();
    for (const Step& step : steps) {
        Step copy = step;  // the same parameters behind it
        list.push_back(io::write_fields(step_fields(copy)));
    }
    return result;
}

}
