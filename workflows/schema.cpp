#include "workflows/schema.h"

#include "io/json_schema.h"
#include "workflows/step_names.h"
#include "workflows/steps.h"
#include "workflows/workflow.h"

namespace sigmaflow::workflows {

using Json = nlohmann::ordered_json;

namespace {

/// The kind of a step decides what else it may have.
Json any_step()
{
    Json kinds = Json::array(), choices = Json::array();
    for (const StepKind& kind : step_kinds()) {
        const std::string name(kind.name);
        kinds.push_back(name);
        const Json is_this = {{"properties", {{"step", {{"const", name}}}}},
                              {"required", {"step"}}};
        choices.push_back({{"if", is_this}, {"then", {{"$ref", "#/$defs/" + name}}}});
    }
    return {{"type", "object"},
            {"required", {"step"}},
            {"properties", {{"step", {{"enum", kinds}, {"description", "kind of the step"}}}}},
            {"allOf", choices}};
}

/// A workflow that begins with a stored run takes the suspension from there.
Json stored_run_first()
{
    const Json stored = {{"type", "object"},
                         {"properties", {{"step", {{"const", "stored_run"}}}}},
                         {"required", {"step"}}};
    return {{"required", {"steps"}},
            {"properties", {{"steps", {{"type", "array"}, {"prefixItems", {stored}}}}}}};
}

}

Json workflow_schema()
{
    Workflow workflow;
    workflow.suspension = std::make_unique<Suspension>();
    std::string schema;
    Json result = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                   {"title", "sigmaflow workflow"}};
    result.update(io::schema_of(workflow_fields(workflow, schema)));
    result["properties"]["steps"] = {{"type", "array"},
                                     {"minItems", 1},
                                     {"maxItems", most_steps},
                                     {"items", any_step()},
                                     {"description", "what is done, one after the other"}};
    result["required"] = {"steps"};
    result["if"] = stored_run_first();
    result["else"] = {{"required", {"suspension"}}};
    Json& definitions = result["$defs"] = Json::object();
    for (const StepKind& kind : step_kinds()) {
        Step step = kind.make();
        Json& definition = definitions[std::string(kind.name)] = io::schema_of(step_fields(step));
        definition["description"] = kind.summary;
    }
    return result;
}

std::string workflow_schema_text()
{
    return workflow_schema().dump(1) + "\n";
}

}
