#include "workflows/forecast.h"

#include "workflows/resumption.h"
#include "workflows/workflow.h"

#include <sys/resource.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <sstream>

namespace sigmaflow::workflows {

namespace fs = std::filesystem;

namespace {

// Measured with the n and volume fractions of forecast.h; pictures from 640 to 3840 pixels wide.
namespace bytes {
constexpr double program = 42e6;
constexpr double solver = 52e3, solver_power = 1.204, volume_fraction_power = 1.765;
constexpr double particle_in_frame = 550, sample_in_memory = sizeof(Sample);
constexpr double drawing = 110e6, drawn_pixel = 178;
constexpr double plotting = 15e6, plotted_pixel = 7.5;

constexpr double particle_in_frame_on_disk = 1100, sample_on_disk = 620;
constexpr double particle_of_step = 4000;  // last state and checkpoints
constexpr double drawn_pixel_on_disk = 0.6, plotted_pixel_on_disk = 0.1;
constexpr double files_of_step = 200e3;  // tables, SVG
}

double memory_of(const Needs& needs)
{
    const double particles = needs.particles;
    double result = needs.frames_read * particles * bytes::particle_in_frame;
    if (needs.volume_fraction > 0)
        result += bytes::solver * std::pow(particles, bytes::solver_power) *
                  std::pow(needs.volume_fraction, bytes::volume_fraction_power);
    if (needs.drawn_pixels > 0) result += bytes::drawing + needs.drawn_pixels * bytes::drawn_pixel;
    if (needs.plotted_pixels > 0)
        result += bytes::plotting + needs.plotted_pixels * bytes::plotted_pixel;
    return result;
}

double disk_of(const Needs& needs)
{
    const double particles = needs.particles;
    return needs.frames * particles * bytes::particle_in_frame_on_disk +
           needs.samples * bytes::sample_on_disk + particles * bytes::particle_of_step +
           needs.drawn_pictures * needs.drawn_pixels * bytes::drawn_pixel_on_disk +
           needs.plotted_pixels * bytes::plotted_pixel_on_disk + bytes::files_of_step;
}

/// What is on the disk already of the step that the checkpoint belongs to.
double stored_bytes(const Checkpoint& checkpoint)
{
    double result = 0;
    for (const FileMark& file : checkpoint.files) result += static_cast<double>(file.mark.size);
    return result;
}

/// The number after a name at the beginning of a line.
std::optional<double> entry(const fs::path& file, const std::string& name)
{
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        std::string first;
        double value = 0;
        if (words >> first && first == name && words >> value) return value;
    }
    return std::nullopt;
}

std::optional<double> number_in(const fs::path& file)
{
    std::ifstream in(file);
    double value = 0;
    if (in >> value) return value;  // "max" is no number: no limit
    return std::nullopt;
}

/// The names of the same things in the two versions of control groups.
struct ControlGroups {
    std::string_view line;  // how the line of the memory begins in /proc/self/cgroup
    const char *root, *limit, *used, *files;
};

constexpr std::array control_groups{
    ControlGroups{"0::", "/sys/fs/cgroup", "memory.max", "memory.current", "inactive_file"},
    ControlGroups{"memory:", "/sys/fs/cgroup/memory", "memory.limit_in_bytes",
                  "memory.usage_in_bytes", "total_inactive_file"}};

/// What the control groups of this process allow, from its own to the outermost.
std::optional<double> left_in(const ControlGroups& groups, const std::string& own)
{
    const fs::path root = groups.root;
    std::optional<double> least;
    for (fs::path group = root / own.substr(1);; group = group.parent_path()) {
        const auto limit = number_in(group / groups.limit);
        const auto used = number_in(group / groups.used);
        if (limit && used) {
            // files that were read can be dropped from memory
            const double files = entry(group / "memory.stat", groups.files).value_or(0);
            const double left = std::clamp(*limit - *used + files, 0., *limit);
            least = std::min(least.value_or(left), left);
        }
        if (group == root || !group.has_relative_path()) return least;
    }
}

std::optional<double> left_in_control_groups()
{
    std::ifstream in("/proc/self/cgroup");
    std::optional<double> least;
    for (std::string line; std::getline(in, line);)
        for (const ControlGroups& groups : control_groups) {
            const std::size_t place = line.find(groups.line), path = line.find('/');
            if (place == std::string::npos || path == std::string::npos || place > path) continue;
            if (const auto left = left_in(groups, line.substr(path)))
                least = std::min(least.value_or(*left), *left);
        }
    return least;
}

/// What is left of the address space of this process, if it is limited.
std::optional<double> left_in_address_space()
{
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return std::nullopt;
    const double used = 1024 * entry("/proc/self/status", "VmSize:").value_or(0);
    return std::max(0., static_cast<double>(limit.rlim_cur) - used);
}

std::string size_text(double size)
{
    constexpr std::array units{"kB", "MB", "GB", "TB", "PB"};
    std::size_t k = 0;
    for (size /= 1e3; size >= 999.5 && k + 1 < units.size(); ++k) size /= 1e3;
    char text[40];
    std::snprintf(text, sizeof text, size < 9.95 ? "%.1f %s" : "%.0f %s", size, units[k]);
    return text;
}

}

Forecast forecast(const Workflow& workflow, const Resumption* plan)
{
    Forecast result;
    double series = 0;  // of all runs, which stays in memory
    for (std::size_t k = 0; k < workflow.steps.size(); ++k) {
        const Step& step = workflow.steps[k];
        series += step.needs.samples * bytes::sample_in_memory;
        if (plan && plan->steps[k].record) continue;
        const double memory = bytes::program + series + memory_of(step.needs);
        if (memory > result.memory) {
            result.memory = memory;
            result.step = step.name;
        }
        result.disk += disk_of(step.needs);
    }
    if (plan && plan->checkpoint)
        result.disk = std::max(0., result.disk - stored_bytes(*plan->checkpoint));
    return result;
}

Room room_here(const fs::path& folder)
{
    Room room;
    const auto limit = [&](std::optional<double> left, const char* what) {
        if (!left || (room.memory && *room.memory <= *left)) return;
        room.memory = left;
        room.memory_limit = what;
    };
    if (const auto kilobytes = entry("/proc/meminfo", "MemAvailable:"))
        limit(*kilobytes * 1024, "available on this machine");
    limit(left_in_control_groups(), "left in the control group of this process");
    limit(left_in_address_space(), "left in the address space of this process (ulimit -v)");
    std::error_code unknown;
    const fs::space_info space = fs::space(folder, unknown);
    if (!unknown && space.available != static_cast<std::uintmax_t>(-1))
        room.disk = static_cast<double>(space.available);
    return room;
}

void check_room(const Forecast& needed, const Room& room, const io::JsonNode& workflow,
                const fs::path& folder)
{
    if (room.memory && needed.memory > *room.memory)
        throw workflow.member("suspension")
            .error_at_key("particles", "the step " + io::in_quotes(needed.step) + " needs about " +
                                           size_text(needed.memory) + " of memory, more than the " +
                                           size_text(*room.memory) + " " + room.memory_limit);
    if (room.disk && needed.disk > *room.disk)
        throw Error(ErrorKind::no_space, folder.string(),
                    "the run needs about " + size_text(needed.disk) + ", the disk has only " +
                        size_text(*room.disk) + " left");
}

std::string forecast_text(const Forecast& needed)
{
    return size_text(needed.memory) + " of memory and " + size_text(needed.disk) + " on disk";
}

}
