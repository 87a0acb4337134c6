#include "workflows/sweep_folder.h"

#include "io/atomic_file.h"
#include "workflows/manifest.h"
#include "workflows/run_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstring>

namespace sigmaflow::workflows {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr const char* lock_name = "sweep.lock";

Json list_of(const std::vector<io::Override>& overrides)
{
    Json list = Json::array();
    for (const io::Override& one : overrides)
        list.push_back({{"pointer", one.pointer}, {"value", one.value}});
    return list;
}

std::vector<io::Override> overrides_of(const io::JsonNode& list)
{
    std::vector<io::Override> result;
    for (const io::JsonNode& one : list.elements())
        result.push_back(
            {"--set", one.member("pointer").text(), one.member("value").text(1'000'000)});
    return result;
}

Json json_of(const SweepFolder& sweep)
{
    Json json = {{"sigmaflow", version()},
                 {"source", sweep.source.string()},
                 {"set", list_of(sweep.sweep.settings)},
                 {"sweep", Json::array()},
                 {"repeats", sweep.sweep.repeats},
                 {"points", Json::array()}};
    for (const Swept& swept : sweep.sweep.swept)
        json["sweep"].push_back({{"pointer", swept.pointer}, {"values", swept.values}});
    for (const Point& point : sweep.points) {
        std::vector<std::string> words = run_arguments(point);
        words.insert(words.begin(), "sigmaflow");
        json["points"].push_back({{"name", point.name},
                                  {"values", point.values},
                                  {"repeat", point.repeat},
                                  {"overrides", list_of(point.overrides)},
                                  {"command", shell_line(words)}});
    }
    return json;
}

std::vector<Json> values_of(const Json& list)
{
    return {list.begin(), list.end()};
}

std::string texts(const std::vector<Json>& values)
{
    std::string text;
    for (const Json& value : values) text += (text.empty() ? "" : ", ") + value_text(value);
    return text;
}

std::string texts(const std::vector<io::Override>& settings)
{
    std::string text;
    for (const io::Override& one : settings)
        text += (text.empty() ? "" : " ") + one.pointer + "=" + one.value;
    return text.empty() ? "nothing" : text;
}

std::string texts(const std::vector<Swept>& swept)
{
    std::string text;
    for (const Swept& one : swept) text += (text.empty() ? "" : ", ") + one.pointer;
    return text.empty() ? "nothing" : text;
}

[[noreturn]] void refuse(const SweepFolder& sweep, const std::string& what, const std::string& was,
                         const std::string& is)
{
    throw Error(ErrorKind::input, sweep.path.string(),
                "holds a sweep with other parameters: " + what + " was " + was + ", is " + is +
                    "; choose another folder with --out");
}

std::string shortened(const Json& value)
{
    const std::string text = value.dump();
    return text.size() > 60 ? text.substr(0, 57) + "..." : text;
}

void refuse_other_workflow(const SweepFolder& before, const SweepFolder& now)
{
    const Json patch = Json::diff(before.workflow, now.workflow);
    if (patch.empty()) return;
    const std::string pointer = patch[0]["path"].get<std::string>();
    const auto value_in = [&](const Json& workflow) {
        const Json::json_pointer place(pointer);
        return workflow.contains(place) ? shortened(workflow[place]) : "not there";
    };
    refuse(now, pointer + " of the workflow", value_in(before.workflow), value_in(now.workflow));
}

bool is_safe(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::strchr("_-./=,:+%@", c);
}

}

fs::path SweepFolder::run_of(const Point& point) const
{
    return path / points_name / point.name;
}

fs::path SweepFolder::log_of(const Point& point) const
{
    return path / points_name / (point.name + ".log");
}

std::vector<std::string> run_arguments(const Point& point)
{
    std::vector<std::string> words{"run", frozen_name, "--out",
                                   std::string(points_name) + "/" + point.name};
    for (const io::Override& one : point.overrides) {
        words.push_back("--set");
        words.push_back(one.pointer + "=" + one.value);
    }
    return words;
}

std::string shell_line(const std::vector<std::string>& words)
{
    std::string line;
    for (const std::string& word : words) {
        if (!line.empty()) line += ' ';
        if (!word.empty() && std::all_of(word.begin(), word.end(), is_safe)) {
            line += word;
            continue;
        }
        line += '\'';
        for (const char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
        line += '\'';
    }
    return line;
}

bool holds_sweep(const fs::path& folder)
{
    std::error_code error;
    return fs::exists(folder / sweep_name, error);
}

SweepFolder read_sweep(const fs::path& folder)
{
    std::error_code error;
    if (!fs::is_directory(folder, error))
        throw Error(ErrorKind::missing, folder.empty() ? "\"\"" : folder.string(),
                    "there is no such folder");
    if (!holds_sweep(folder))
        throw Error(ErrorKind::input, folder.string(),
                    std::string("is not the folder of a sweep: it has no ") + sweep_name);
    SweepFolder result{.path = folder, .source = {}, .workflow = {}, .sweep = {}, .points = {}};
    result.workflow = Json::parse(io::JsonDocument::read(folder / frozen_name).text());
    const io::JsonDocument document = io::JsonDocument::read(folder / sweep_name);
    const io::JsonNode root = document.root();
    const Json values = Json::parse(document.text());
    result.source = root.member("source").text();
    result.sweep.settings = overrides_of(root.member("set"));
    result.sweep.repeats = static_cast<int>(root.member("repeats").integer(1, most_points));
    for (std::size_t k = 0; const io::JsonNode& swept : root.member("sweep").elements()) {
        swept.member("values").elements({1, most_points});
        result.sweep.swept.push_back(
            {swept.member("pointer").text(), values_of(values["sweep"][k++]["values"])});
    }
    const io::Length one_each = io::Length::exactly(result.sweep.swept.size());
    for (std::size_t k = 0; const io::JsonNode& point : root.member("points").elements()) {
        point.member("values").elements(one_each);
        const std::string name = point.member("name").text();
        if (!is_inside(name) || name.find('/') != std::string::npos)
            throw point.member("name").wrong("must be the name of a folder");
        result.points.push_back(
            {.name = name,
             .values = values_of(values["points"][k++]["values"]),
             .repeat = static_cast<int>(point.member("repeat").integer(1, most_points)),
             .overrides = overrides_of(point.member("overrides"))});
    }
    return result;
}

void write_sweep(const SweepFolder& sweep)
{
    std::error_code error;
    fs::create_directories(sweep.path / points_name, error);
    if (error)
        throw Error(ErrorKind::file, (sweep.path / points_name).string(),
                    "cannot make the folder: " + error.message());
    io::write_file(sweep.path / frozen_name, sweep.workflow.dump(2) + "\n");
    io::write_file(sweep.path / sweep_name,
                   json_of(sweep).dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

void refuse_other_sweep(const SweepFolder& before, const SweepFolder& now)
{
    refuse_other_workflow(before, now);
    if (texts(before.sweep.settings) != texts(now.sweep.settings))
        refuse(now, "--set", texts(before.sweep.settings), texts(now.sweep.settings));
    if (texts(before.sweep.swept) != texts(now.sweep.swept))
        refuse(now, "--sweep", texts(before.sweep.swept), texts(now.sweep.swept));
    for (std::size_t k = 0; k < now.sweep.swept.size(); ++k) {
        const Swept &old = before.sweep.swept[k], &given = now.sweep.swept[k];
        for (const Json& value : old.values)
            if (std::find(given.values.begin(), given.values.end(), value) == given.values.end())
                refuse(now, given.pointer, texts(old.values),
                       texts(given.values) + " (values can be added, not left out)");
    }
    if (before.sweep.repeats > now.sweep.repeats)
        refuse(now, "--repeat", std::to_string(before.sweep.repeats),
               std::to_string(now.sweep.repeats) + " (repeats can be added, not left out)");
}

SweepLock::SweepLock(const fs::path& folder)
{
    std::error_code error;
    fs::create_directories(folder, error);
    if (error || !fs::is_directory(folder, error))
        throw Error(ErrorKind::file, folder.string(),
                    "cannot make the folder" + (error ? ": " + error.message() : ""));
    if (!holds_sweep(folder) && !fs::exists(folder / lock_name, error) &&
        !fs::is_empty(folder, error))
        throw Error(ErrorKind::file, folder.string(),
                    "is not empty and holds no earlier sweep; choose another folder with --out");
    const fs::path path = folder / lock_name;
    descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (descriptor_ < 0)
        throw Error(ErrorKind::file, path.string(),
                    std::string("cannot be opened: ") + std::strerror(errno));
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
        ::close(descriptor_);
        const std::string owner = io::read_file(path, 1000);
        throw Error(ErrorKind::locked, folder.string(),
                    (owner.empty() ? "another process" : owner.substr(0, owner.find('\n'))) +
                        " is working on this sweep");
    }
    const std::string name = "process " + std::to_string(getpid()) + " on " + host_name() + "\n";
    // the name only helps people: the lock does not depend on it
    if (::ftruncate(descriptor_, 0) == 0) {
        [[maybe_unused]] const auto written = ::write(descriptor_, name.data(), name.size());
    }
}

SweepLock::~SweepLock()
{
    ::close(descriptor_);
}

}
