#include "workflows/run_status.h"

#include "workflows/checkpoint.h"
#include "workflows/folder_owner.h"
#include "workflows/past_run.h"
#include "workflows/report.h"

#include <algorithm>
#include <ctime>
#include <fstream>

namespace sigmaflow::workflows {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

std::string quoted_for_shell(const std::string& word)
{
    const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               std::string_view("/._-+=,:").find(c) != std::string_view::npos;
    });
    if (plain) return word;
    std::string result = "'";
    for (const char c : word) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + "'";
}

std::optional<std::time_t> time_of(const std::string& utc)
{
    std::tm parts{};
    if (!strptime(utc.c_str(), "%Y-%m-%dT%H:%M:%SZ", &parts)) return std::nullopt;
    return timegm(&parts);
}

/// The strain in the last whole row of series.csv.
std::optional<double> last_strain(const fs::path& series)
{
    std::ifstream file(series, std::ios::binary | std::ios::ate);
    if (!file) return std::nullopt;
    constexpr std::streamoff enough = 4096;
    const std::streamoff size = file.tellg(), begin = std::max<std::streamoff>(0, size - enough);
    std::string end(static_cast<std::size_t>(size - begin), '\0');
    file.seekg(begin).read(end.data(), static_cast<std::streamsize>(end.size()));
    const std::size_t stop = end.rfind('\n');
    if (stop == std::string::npos || stop == 0) return std::nullopt;
    const std::size_t start = end.rfind('\n', stop - 1);
    if (start == std::string::npos) return std::nullopt;
    char* parsed = nullptr;
    const double value = std::strtod(end.c_str() + start + 1, &parsed);
    return parsed == end.c_str() + start + 1 ? std::nullopt : std::optional(value);
}

std::optional<double> end_of(const Json& parameters)
{
    for (const char* key : {"strain", "maximum_strain"})
        if (parameters.contains(key) && parameters[key].is_number() && parameters[key] > 0)
            return parameters[key].get<double>();
    return std::nullopt;
}

/// The checkpoints of a step that can be read, the newest first.
std::vector<Checkpoint> checkpoints_of(const RunFolder& folder, const std::string& step)
{
    std::vector<Checkpoint> found;
    for (const char* name : {"checkpoint.0", "checkpoint.1"}) {
        try {
            Checkpoint one = read_checkpoint(folder.own_file(name));
            one.run.clear();  // may be large
            if (one.step.name == step) found.push_back(std::move(one));
        } catch (const Error&) {  // none, or damaged: the next run says so
        }
    }
    std::sort(found.begin(), found.end(),
              [](const Checkpoint& a, const Checkpoint& b) { return a.generation > b.generation; });
    return found;
}

/// Strain per second of the running step, from checkpoints of this run or since it began.
std::optional<double> pace(const std::vector<Checkpoint>& stored, const RunStatus& run,
                           const fs::path& manifest)
{
    const auto started = time_of(run.started);
    std::error_code error;
    const auto seconds_old = std::chrono::duration<double>(fs::file_time_type::clock::now() -
                                                           fs::last_write_time(manifest, error));
    if (stored.size() == 2) {
        const auto late = time_of(stored[0].written), early = time_of(stored[1].written);
        if (late && early && started && *early >= *started && *late > *early)
            return (stored[0].strain - stored[1].strain) / static_cast<double>(*late - *early);
        if (early && started && *early < *started) return std::nullopt;  // goes on
    }
    if (stored.size() == 1) {
        const auto written = time_of(stored[0].written);
        if (written && started && *written < *started) return std::nullopt;
    }
    // manifest.json was written when the step began
    if (error || !run.strain || seconds_old.count() < 1) return std::nullopt;
    return *run.strain / seconds_old.count();
}

void look_at_current_step(RunStatus& run, const PastRun& past, std::size_t current)
{
    const PastStep& step = past.steps[current];
    const RunFolder folder = RunFolder::to_read(past.folder);
    const std::vector<Checkpoint> stored = checkpoints_of(folder, step.name);
    const auto end = end_of(step.parameters);
    const auto share = [&](double strain) {
        return end ? std::optional(std::min(1., strain / *end)) : std::nullopt;
    };
    if (!stored.empty())
        run.checkpoint = {step.name, stored[0].written, stored[0].strain, share(stored[0].strain)};
    if (run.state != "running") return;
    run.strain = last_strain(past.folder / step.name / series_name);
    if (!run.strain) return;
    run.share = share(*run.strain);
    const auto speed = pace(stored, run, past.folder / manifest_name);
    if (speed && *speed > 0 && end)
        run.step_seconds_left = std::max(0., *end - *run.strain) / *speed;
}

std::string next_command(const RunStatus& run)
{
    const std::string folder = quoted_for_shell(run.folder);
    if (run.state == "complete") return "sigmaflow report " + folder;
    if (run.state == "running" || run.state == "unknown") return "sigmaflow status " + folder;
    return "sigmaflow run " + quoted_for_shell(run.workflow_file) + " --out " + folder;
}

/// Nothing was finished: not even a manifest.
RunStatus begun(const fs::path& folder, const FolderOwner& owner, Writing writing)
{
    RunStatus run;
    run.folder = folder.string();
    run.state = writing == Writing::yes ? "running" : "killed";
    run.owner = owner.text;
    run.next = writing == Writing::yes
                   ? "sigmaflow status " + quoted_for_shell(run.folder)
                   : "sigmaflow run WORKFLOW.json --out " + quoted_for_shell(run.folder);
    return run;
}

std::string state_of(const std::string& told, Writing writing)
{
    if (writing == Writing::yes) return "running";
    if (told != "running") return told;
    return writing == Writing::unknown ? "unknown" : "killed";
}

}

RunStatus status_of(const fs::path& folder)
{
    const FolderOwner owner = read_owner(folder);
    const Writing writing = is_written(folder);
    std::error_code error;
    if (fs::is_directory(folder / own_folder, error) && !fs::exists(folder / manifest_name, error))
        return begun(folder, owner, writing);
    const PastRun past = read_past_run(folder);
    RunStatus run;
    run.folder = folder.string();
    run.workflow = past.title();
    run.workflow_file = past.manifest.value("workflow_file", "");
    run.started = past.manifest.value("started", "");
    if (past.manifest.contains("ended") && past.manifest["ended"].is_string())
        run.ended = past.manifest["ended"];
    run.error = past.manifest.value("error", "");
    run.owner = owner.text;
    run.state = state_of(past.manifest["status"], writing);
    std::optional<std::size_t> current;
    for (std::size_t k = 0; k < past.steps.size(); ++k) {
        const PastStep& step = past.steps[k];
        StepStatus line{step.name, step.kind, "done", "", step.wall_seconds};
        if (!step.wall_seconds) {
            line.state = current ? "to do" : run.state;
            if (!current) current = k;
        } else if (step.results.is_object()) {
            Json entry = {{"step", step.kind}};
            entry.update(step.results);
            line.outcome = one_line(entry);
        }
        run.steps.push_back(std::move(line));
    }
    if (current) look_at_current_step(run, past, *current);
    run.next = next_command(run);
    return run;
}

}
