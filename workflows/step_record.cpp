#include "workflows/step_record.h"

#include "engine/archive.h"
#include "io/sealed_file.h"

#include <nlohmann/json.hpp>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::ordered_json;

constexpr io::Seal seal{"step record", 2};

const std::string& key_of(const std::vector<StepIdentity>& steps, const std::string& name)
{
    for (const StepIdentity& step : steps)
        if (step.name == name) return step.key;
    throw Error(ErrorKind::internal, name, "is used by a step before it");
}

}

std::vector<StepIdentity> identities(const Workflow& workflow)
{
    const Json resolved = workflow.resolved();
    std::vector<StepIdentity> result;
    std::string chain;  // key of the last step that changed the state
    for (std::size_t i = 0; i < workflow.steps.size(); ++i) {
        const Step& step = workflow.steps[i];
        Json parameters = resolved["steps"][i];
        for (const std::filesystem::path& input : step.inputs)
            parameters["checksum"][input.string()] = io::hexadecimal(io::file_checksum(input));
        StepIdentity identity{.name = step.name,
                              .kind = step.kind,
                              .parameters = parameters.dump(),
                              .suspension = resolved["suspension"].dump(),
                              .key = {}};
        std::string before = step.uses.empty() && step.inputs.empty() ? chain : "";
        for (const std::string& used : step.uses) before += key_of(result, used);
        ArchiveWriter a;
        a(identity, before);
        identity.key = io::hexadecimal(io::checksum(a.bytes()));
        // what comes later depends on all stored runs before it, too
        if (step.changes_state)
            chain = identity.key;
        else if (!step.inputs.empty())
            chain += identity.key;
        result.push_back(std::move(identity));
    }
    return result;
}

std::filesystem::path record_path(const RunFolder& folder, const std::string& step)
{
    return folder.own_file(step + record_ending);
}

void write_record(const RunFolder& folder, const StepRecord& record)
{
    ArchiveWriter a;
    a(record);
    io::write_sealed(record_path(folder, record.identity.name), seal, a.bytes());
}

StepRecord read_record(const std::filesystem::path& path)
{
    const std::string bytes = io::read_sealed(path, seal);
    StepRecord record;
    try {
        ArchiveReader a(bytes);
        a(record);
        a.finish();
        if (record.state) check_stored_state(*record.state);
        if (!Json::accept(record.results)) ArchiveReader::refuse("has results that are not JSON");
    } catch (const Error& error) {
        throw error.within(path.string());
    }
    return record;
}

std::string changes(const std::string& old_json, const std::string& new_json)
{
    const Json before = Json::parse(old_json, nullptr, false);
    const Json after = Json::parse(new_json, nullptr, false);
    if (before.is_discarded() || after.is_discarded()) return "parameters were damaged";
    constexpr std::size_t longest_value = 60, longest_text = 400;
    const auto text_at = [](const Json& json, const Json::json_pointer& place) {
        std::string text = json.contains(place) ? json[place].dump() : "not given";
        return text.size() > longest_value ? text.substr(0, longest_value) + "..." : text;
    };
    std::string result;
    for (const Json& change : Json::diff(before, after)) {
        if (result.size() > longest_text) return result + "; ...";
        const Json::json_pointer place(change["path"].get<std::string>());
        if (!result.empty()) result += "; ";
        result += place.to_string().substr(1) + " was " + text_at(before, place) + ", is " +
                  text_at(after, place);
    }
    return result;
}

}
