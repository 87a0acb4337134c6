#include "workflows/doctor.h"

#include "workflows/blas_kernel.h"
#include "workflows/forecast.h"
#include "workflows/manifest.h"

#include <sched.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

namespace sigmaflow::workflows {

namespace fs = std::filesystem;
using Level = Finding::Level;

namespace {

std::string gigabytes(double bytes)
{
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.2g GB", bytes / 1e9);
    return text.data();
}

/// Cores that the control groups leave to this process; nothing: no limit.
std::optional<double> quota_of_control_groups()
{
    const auto words = [](const fs::path& file) {
        std::ifstream in(file);
        double quota = 0, period = 0;
        return in >> quota >> period && quota > 0 && period > 0 ? std::optional(quota / period)
                                                                : std::nullopt;
    };
    std::optional<double> least;
    const auto take = [&](std::optional<double> cores) {
        if (cores) least = std::min(least.value_or(*cores), *cores);
    };
    std::ifstream groups("/proc/self/cgroup");
    for (std::string line; std::getline(groups, line);)
        if (line.starts_with("0::/"))
            for (fs::path group = line.substr(4);; group = group.parent_path()) {
                take(words(fs::path("/sys/fs/cgroup") / group / "cpu.max"));
                if (group.empty()) break;
            }
    double quota = 0, period = 0;  // version 1
    std::ifstream("/sys/fs/cgroup/cpu/cpu.cfs_quota_us") >> quota;
    std::ifstream("/sys/fs/cgroup/cpu/cpu.cfs_period_us") >> period;
    if (quota > 0 && period > 0) take(quota / period);
    return least;
}

Finding examine_threads()
{
    cpu_set_t allowed;
    CPU_ZERO(&allowed);
    const int cores = static_cast<int>(std::thread::hardware_concurrency());
    const bool known = sched_getaffinity(0, sizeof allowed, &allowed) == 0;
    return judge_threads(static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN)),
                         known ? CPU_COUNT(&allowed) : cores, quota_of_control_groups());
}

Finding examine_clock(const fs::path& folder)
{
    // what the file system thinks of now: another machine's clock on a network
    const fs::path probe = folder / (".sigmaflow-doctor-clock-" + std::to_string(getpid()));
    double ahead = 0;
    std::ofstream(probe) << "now\n";
    struct stat status {};
    const double now =
        std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
    if (::stat(probe.c_str(), &status) == 0)
        ahead = static_cast<double>(status.st_mtim.tv_sec) - now;
    std::error_code ignored;
    fs::remove(probe, ignored);
    return judge_clock(now, ahead);
}

Finding examine_slurm()
{
    Finding found{"slurm", Level::info, "", "", ErrorKind::missing};
    if (const char* job = std::getenv("SLURM_JOB_ID")) {
        found.text = std::string("inside job ") + job;
        return found;
    }
    const char* path = std::getenv("PATH");
    std::istringstream folders(path ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');)
        if (::access((folder + "/sbatch").c_str(), X_OK) == 0) {
            found.text = "present (" + folder + "/sbatch)";
            return found;
        }
    found.text = "not present, not needed";
    return found;
}

}

std::string_view level_name(Level level)
{
    constexpr std::array names{"OK", "INFO", "WARN", "FAIL"};
    return names[static_cast<std::size_t>(level)];
}

Finding judge_instructions(const std::string& arithmetic)
{
    const std::string level = arithmetic.substr(0, arithmetic.find(','));
    Finding found{"processor", Level::ok, level, "", ErrorKind::rendering};
    if (level == "x86-64-v3") {
        found.text += " (AVX2; with AVX-512 runs take a quarter less)";
    } else if (level != "x86-64-v4") {
        found.level = Level::warn;
        found.text += ": no AVX2, runs take about three times as long";
        found.mend =
            "use a processor of 2013 or later, or let the virtual machine pass its "
            "instructions on (CPU type \"host\")";
    }
    return found;
}

Finding judge_blas(const std::string& kernel)
{
    Finding found{"blas", Level::ok, kernel, "", ErrorKind::rendering};
    for (const char* slow : {"Prescott", "Generic", "generic", "Nehalem", "Core2", "Penryn"})
        if (kernel.find(slow) != std::string::npos) {
            found.level = Level::warn;
            found.text += ": a slow kernel, direct solutions take twice as long";
            found.mend = "unset OPENBLAS_CORETYPE, or set it to Haswell or SkylakeX";
        }
    if (kernel == "not OpenBLAS") {
        found.level = Level::warn;
        found.text = "not OpenBLAS: direct solutions may take several times as long";
        found.mend = "apt-get install libopenblas0-pthread";
    }
    return found;
}

Finding judge_memory(const std::optional<double>& memory, const std::string& limit)
{
    Finding found{"memory", Level::ok, "", "", ErrorKind::input};
    if (!memory) {
        found.level = Level::info;
        found.text = "cannot be asked here";
        return found;
    }
    // forecast.h, at volume fraction 0.57
    const double solver = std::max(0., *memory - 60e6) / (52e3 * std::pow(0.57, 1.765));
    const double particles = std::pow(solver, 1 / 1.204);
    found.text = gigabytes(*memory) + " " + limit + ", for about " +
                 std::to_string(std::lround(particles / 100) * 100) + " particles";
    if (particles < 10000) {
        found.level = particles < 500 ? Level::fail : Level::warn;
        found.mend = limit.find("ulimit") != std::string::npos
                         ? "raise it: ulimit -v unlimited"
                         : "end other programs, ask for more memory (Slurm: --mem), or take fewer "
                           "particles";
    }
    return found;
}

Finding judge_threads(int cores, int usable, const std::optional<double>& quota)
{
    Finding found{"threads", Level::ok, "", "", ErrorKind::rendering};
    found.text =
        std::to_string(usable) + " of " + std::to_string(cores) + (cores == 1 ? " core" : " cores");
    if (!quota || *quota >= usable) return found;
    std::array<char, 32> share{};
    std::snprintf(share.data(), share.size(), "%.3g", *quota);
    found.level = Level::warn;
    found.text += ", but the control group gives the time of " + std::string(share.data());
    found.mend = "use no more than --threads " +
                 std::to_string(std::max(1, static_cast<int>(*quota))) +
                 ", or raise the limit of the container";
    return found;
}

Finding judge_clock(double now, double file_system_ahead)
{
    constexpr double year_2024 = 1704067200, year_2100 = 4102444800, tolerated = 10;  // s
    Finding found{"clock", Level::ok, "", "", ErrorKind::rendering};
    found.text = utc_now();
    if (now < year_2024 || now > year_2100) {
        found.level = Level::warn;
        found.text = "the date of this machine cannot be right";
        found.mend = "set it: timedatectl set-ntp true";
    } else if (std::abs(file_system_ahead) > tolerated) {
        found.level = Level::warn;
        found.text = "the file system's clock differs by " +
                     std::to_string(std::lround(file_system_ahead)) + " s";
        found.mend = "let both machines keep network time: timedatectl set-ntp true";
    }
    return found;
}

std::vector<Finding> examine(const fs::path& folder)
{
    std::error_code error;
    if (!fs::is_directory(folder, error))
        throw Error(ErrorKind::missing, folder.string(), "is not a folder");
    const Room room = room_here(folder);
    return {examine_pictures(),
            examine_fonts(),
            examine_hdf5(folder),
            examine_vtk(folder),
            examine_folder(folder),
            examine_lock(folder),
            judge_memory(room.memory, room.memory_limit),
            examine_threads(),
            judge_instructions(arithmetic()),
            judge_blas(blas_kernel()),
            examine_locale(),
            examine_clock(folder),
            examine_slurm()};
}

}
