#include "workflows/point_status.h"

#include "io/atomic_file.h"
#include "workflows/pool.h"
#include "workflows/run_folder.h"

#include <signal.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <set>

namespace sigmaflow::workflows {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr int interrupted_code = static_cast<int>(ErrorKind::interrupted);

constexpr std::array<std::string_view, 5> names{"waiting", "running", "interrupted", "complete",
                                                "failed"};

/// "08:01:1234" of every file and folder that a process of this machine has locked.
std::set<std::string> locked_files()
{
    std::set<std::string> result;
    std::ifstream locks("/proc/locks");
    for (std::string line; std::getline(locks, line);) {
        const auto type = line.find("FLOCK");
        if (type == std::string::npos) continue;
        // FLOCK  ADVISORY  WRITE 1234 08:01:5678 0 EOF
        std::array<char, 64> place{};
        if (std::sscanf(line.c_str() + type, "FLOCK %*s %*s %*d %63s", place.data()) == 1)
            result.insert(place.data());
    }
    return result;
}

bool is_locked(const fs::path& folder, const std::set<std::string>& locked)
{
    struct stat found {};
    if (stat(folder.c_str(), &found) != 0) return false;
    std::array<char, 64> place{};
    std::snprintf(place.data(), place.size(), "%02x:%02x:%lu", major(found.st_dev),
                  minor(found.st_dev), static_cast<unsigned long>(found.st_ino));
    return locked.contains(place.data());
}

Json json_in(const fs::path& file)
{
    try {
        return Json::parse(io::read_file(file), nullptr, false);
    } catch (const Error&) {
        return nullptr;
    }
}

/// Long runs say a lot: only what comes last is of interest.
std::string end_of(const fs::path& file)
{
    constexpr std::streamoff longest = 64 << 10;
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    if (!stream) return "";
    const std::streamoff size = stream.tellg();
    stream.seekg(std::max<std::streamoff>(0, size - longest));
    return {std::istreambuf_iterator<char>(stream), {}};
}

PointStatus status_of(const fs::path& folder, const fs::path& log,
                      const std::set<std::string>& locked)
{
    PointStatus status;
    const Json manifest = json_in(folder / manifest_name);
    std::error_code error;
    const bool begun = manifest.is_object();
    const std::string said = begun ? manifest.value("status", "") : "";
    const Json summary = begun ? json_in(folder / summary_name) : Json();
    if (summary.is_object() && summary.contains("steps") && summary["steps"].is_object())
        status.steps = summary["steps"];
    const std::string text = end_of(log);
    const auto code = exit_code_in(text);
    const bool stopped = code == interrupted_code || code == 128 + SIGTERM || code == 128 + SIGUSR1;
    if (is_locked(folder, locked)) {
        status.state = PointState::running;
    } else if (said == "complete") {
        status.state = PointState::complete;
    } else if (stopped) {
        status.state = PointState::interrupted;
    } else if (code && *code != 0) {
        status.state = PointState::failed;
        status.exit_code = code;
        status.message = last_error_in(text);
    } else if (begun || fs::exists(log, error)) {
        status.state = PointState::interrupted;
    }
    return status;
}

}

std::string_view word_of(PointState state)
{
    return names[static_cast<std::size_t>(state)];
}

std::vector<PointStatus> read_status(const SweepFolder& sweep)
{
    const std::set<std::string> locked = locked_files();
    std::vector<PointStatus> result;
    for (const Point& point : sweep.points)
        result.push_back(status_of(sweep.run_of(point), sweep.log_of(point), locked));
    return result;
}

std::string count_text(const std::vector<PointStatus>& status)
{
    std::string text;
    for (const PointState state :
         {PointState::complete, PointState::failed, PointState::interrupted, PointState::running,
          PointState::waiting}) {
        const auto count = std::count_if(status.begin(), status.end(), [&](const PointStatus& one) {
            return one.state == state;
        });
        if (count == 0) continue;
        text += (text.empty() ? "" : ", ") + std::to_string(count) + " ";
        text += word_of(state);
    }
    return text.empty() ? "no points" : text;
}

std::string failure_text(const PointStatus& status)
{
    const std::string code =
        status.exit_code ? "exit code " + std::to_string(*status.exit_code) : "";
    return code + (code.empty() || status.message.empty() ? "" : ", ") + status.message;
}

std::string last_error_in(const std::string& log)
{
    const std::string words = "sigmaflow: error: ";
    const auto begin = log.rfind(words);
    if (begin == std::string::npos) return "";
    return log.substr(begin + words.size(), log.find('\n', begin) - begin - words.size());
}

}
