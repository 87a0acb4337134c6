#include "workflows/past_run.h"

#include "io/json_document.h"
#include "workflows/report.h"
#include "workflows/run_folder.h"

#include <algorithm>
#include <set>

namespace sigmaflow::workflows {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

void require_folder(const fs::path& folder)
{
    std::error_code error;
    const fs::file_status status = fs::status(folder, error);
    if (!fs::exists(status))
        throw Error(ErrorKind::missing, folder.empty() ? "\"\"" : folder.string(),
                    "cannot be read: " + (error ? error.message() : "no such folder"));
    if (!fs::is_directory(status))
        throw Error(ErrorKind::input, folder.string(), "is not a folder of a run");
    if (!fs::exists(folder / manifest_name, error))
        throw Error(ErrorKind::input, folder.string(),
                    std::string("is not the folder of a run: it has no ") + manifest_name);
}

/// The text of a document that is known to be right, as a value.
Json value_of(const io::JsonDocument& document)
{
    return Json::parse(document.text());
}

Json read_manifest(const fs::path& folder)
{
    const io::JsonDocument document = io::JsonDocument::read(folder / manifest_name);
    const io::JsonNode root = document.root();
    root.member("sigmaflow").text();
    root.member("status").text();
    const io::JsonNode workflow = root.member("workflow");
    workflow.member("name").text();
    if (const auto description = workflow.find("description")) description->text(100'000);
    for (const io::JsonNode& step : workflow.member("steps").elements()) {
        step.member("step").text();
        step.member("name").text();
    }
    for (const io::JsonNode& step : root.member("steps").elements()) {
        step.member("name").text();
        step.member("wall_seconds").number();
    }
    for (const io::JsonNode& file : root.member("files").elements()) {
        file.member("name").text();
        file.member("size").number();
    }
    return value_of(document);
}

/// The results by the name of the step.
Json read_summary(const fs::path& folder)
{
    std::error_code error;
    if (!fs::exists(folder / summary_name, error)) return Json::object();
    const io::JsonDocument document = io::JsonDocument::read(folder / summary_name);
    const io::JsonNode steps = document.root().member("steps");
    for (const std::string& name : steps.keys()) steps.member(name).keys();
    return value_of(document)["steps"];
}

/// How much of the name of a file is that of the step: all of it but the ending, or up to a _ or /.
std::size_t claim(const std::string& step, const std::string& file)
{
    if (!file.starts_with(step)) return 0;
    const std::string_view rest = std::string_view(file).substr(step.size());
    const bool ending = rest.starts_with('.') && rest.find_last_of("./") == 0;
    return rest.starts_with('/') || rest.starts_with('_') || ending ? step.size() : 0;
}

void give_to_its_step(PastRun& run, PastFile file)
{
    PastStep* owner = nullptr;
    std::size_t best = 0;
    for (PastStep& step : run.steps)
        if (const std::size_t length = claim(step.name, file.name); length > best) {
            best = length;
            owner = &step;
        }
    (owner ? owner->files : run.files).push_back(std::move(file));
}

/// The names of parameters that differ, but for the name.
std::set<std::string> differences(const Json& a, const Json& b)
{
    std::set<std::string> result;
    for (const auto& [one, other] : {std::pair(&a, &b), std::pair(&b, &a)})
        for (const auto& [key, value] : one->items())
            if (key != "name" && (!other->contains(key) || (*other)[key] != value))
                result.insert(key);
    return result;
}

/// The parameter in which b differs from a; empty: none; nothing: they cannot be told together.
std::optional<std::string> parameter_between(const PastStep& a, const PastStep& b)
{
    for (const PastStep* step : {&a, &b})
        if (!step->files_ending(".png").empty() || !step->files_ending(".svg").empty())
            return std::nullopt;
    const std::set<std::string> keys = differences(a.parameters, b.parameters);
    if (a.kind != b.kind || keys.size() > 1) return std::nullopt;
    return keys.empty() ? "" : *keys.begin();
}

}

std::vector<PastFile> PastStep::files_ending(const std::string& ending) const
{
    std::vector<PastFile> result;
    std::copy_if(files.begin(), files.end(), std::back_inserter(result),
                 [&](const PastFile& file) { return file.name.ends_with(ending); });
    return result;
}

bool PastStep::has_means() const
{
    return std::any_of(results.begin(), results.end(), is_mean);
}

std::string PastRun::title() const
{
    return manifest["workflow"]["name"].get<std::string>();
}

std::string PastRun::description() const
{
    return manifest["workflow"].value("description", "");
}

PastRun read_past_run(const fs::path& folder)
{
    require_folder(folder);
    PastRun run{.folder = folder, .manifest = read_manifest(folder), .steps = {}, .files = {}};
    const Json summary = read_summary(folder);
    for (const Json& parameters : run.manifest["workflow"]["steps"])
        run.steps.push_back({.name = parameters["name"],
                             .kind = parameters["step"],
                             .parameters = parameters,
                             .results = nullptr,
                             .wall_seconds = {},
                             .files = {}});
    for (const Json& finished : run.manifest["steps"])
        for (PastStep& step : run.steps) {
            if (step.name != finished["name"]) continue;
            step.wall_seconds = finished["wall_seconds"].get<double>();
            // the summary may be that of an earlier run: only what this one has finished counts
            if (summary.contains(step.name)) step.results = summary[step.name];
        }
    for (const Json& listed : run.manifest["files"]) {
        PastFile file{listed["name"], listed["size"].get<double>(), false};
        if (!is_inside(file.name)) continue;
        std::error_code error;
        file.exists = fs::is_regular_file(folder / file.name, error);
        give_to_its_step(run, std::move(file));
    }
    return run;
}

std::vector<Chapter> chapters(const PastRun& run)
{
    std::vector<Chapter> result;
    for (std::size_t k = 0; k < run.steps.size(); k += result.back().count) {
        Chapter chapter{.first = k, .count = 1, .parameter = ""};
        bool has_means = run.steps[k].has_means();
        for (std::size_t next = k + 1; next < run.steps.size(); ++next, ++chapter.count) {
            const auto parameter = parameter_between(run.steps[k], run.steps[next]);
            if (!parameter) break;
            if (chapter.parameter.empty()) chapter.parameter = *parameter;
            if (!parameter->empty() && *parameter != chapter.parameter) break;
            has_means = has_means || run.steps[next].has_means();
        }
        if (chapter.parameter.empty() || !has_means)
            chapter = {.first = k, .count = 1, .parameter = ""};
        result.push_back(std::move(chapter));
    }
    return result;
}

}
