#include "workflows/manifest.h"

#include "io/atomic_file.h"
#include "workflows/blas_kernel.h"

#include <H5public.h>
#include <SuiteSparse_config.h>
#include <unistd.h>
#include <vtkVersionMacros.h>
#include <CLI/Version.hpp>
#include <Eigen/Core>
#include <array>
#include <chrono>
#include <ctime>
#include <fstream>
#include <thread>

namespace sigmaflow::workflows {

using Json = nlohmann::ordered_json;

namespace {

std::string joined(std::initializer_list<int> numbers)
{
    std::string result;
    for (int number : numbers) {
        if (!result.empty()) result += '.';
        result += std::to_string(number);
    }
    return result;
}

std::string processor()
{
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("model name"))
            if (const auto colon = line.find(": "); colon != std::string::npos)
                return line.substr(colon + 2);
    return "unknown";
}

}

std::string host_name()
{
    std::array<char, 256> name{};
    return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

std::string version()
{
    return SIGMAFLOW_VERSION;
}

Json library_versions()
{
    return {{"eigen", joined({EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION})},
            {"suitesparse", joined({SUITESPARSE_MAIN_VERSION, SUITESPARSE_SUB_VERSION,
                                    SUITESPARSE_SUBSUB_VERSION})},
            {"blas", blas_kernel()},
            {"vtk", VTK_VERSION},
            {"hdf5", joined({H5_VERS_MAJOR, H5_VERS_MINOR, H5_VERS_RELEASE})},
            {"nlohmann_json", joined({NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR,
                                      NLOHMANN_JSON_VERSION_PATCH})},
            {"cli11", CLI11_VERSION}};
}

std::string arithmetic()
{
    std::string instructions = "x86-64";
#if defined(__x86_64__)
    // asked for by one instruction set of each level, clang 14 does not know the levels
    if (__builtin_cpu_supports("avx2")) instructions = "x86-64-v3";
    if (__builtin_cpu_supports("avx512vl")) instructions = "x86-64-v4";
#endif
    return instructions + ", " + blas_kernel();
}

std::string utc_now()
{
    const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
    std::tm parts{};
    gmtime_r(&now, &parts);
    std::array<char, 32> text{};
    std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts);
    return text.data();
}

Manifest::Manifest(const Workflow& workflow, const std::filesystem::path& workflow_file,
                   const std::vector<io::Override>& overrides, int threads)
{
    content_["sigmaflow"] = version();
    content_["status"] = "running";
    content_["started"] = utc_now();
    content_["ended"] = nullptr;
    content_["workflow_file"] = std::filesystem::absolute(workflow_file).string();
    content_["overrides"] = Json::array();
    for (const io::Override& given : overrides)
        content_["overrides"].push_back(given.pointer + "=" + given.value);
    content_["seed"] = workflow.suspension->packing.seed;
    content_["host"] = host_name();
    content_["processor"] = processor();
    content_["cores"] = std::thread::hardware_concurrency();
    content_["threads"] = threads;
    content_["arithmetic"] = arithmetic();
    content_["compiler"] = SIGMAFLOW_COMPILER;
    content_["libraries"] = library_versions();
    content_["workflow"] = workflow.resolved();
    content_["steps"] = Json::array();
    content_["files"] = Json::array();
}

void Manifest::add_step(const StepRecord& record)
{
    const StepIdentity& step = record.identity;
    content_["steps"].push_back(
        {{"name", step.name}, {"step", step.kind}, {"wall_seconds", record.wall_seconds}});
    for (const ResultFile& file : record.files)
        content_["files"].push_back(
            {{"name", file.name}, {"size", file.size}, {"xxh3", io::hexadecimal(file.digest)}});
}

namespace {

constexpr std::string_view before_seal = ",\n  \"seal\": \"", after_seal = "\"\n}\n";

/// Files that are written anew after every step and belong to none.
Json files_of_run(const RunFolder& folder)
{
    Json list = Json::array();
    for (const char* name : {summary_name, "resolved.json"}) {
        std::error_code error;
        const auto size = std::filesystem::file_size(folder.path() / name, error);
        if (error) continue;
        const io::Digest digest = io::file_checksum(folder.path() / name);
        list.push_back({{"name", name}, {"size", size}, {"xxh3", io::hexadecimal(digest)}});
    }
    return list;
}

}

std::string with_seal(const Json& manifest)
{
    // paths and host names need not be UTF-8
    std::string text = manifest.dump(2, ' ', false, Json::error_handler_t::replace);
    text.resize(text.size() - 2);  // "\n}"
    const std::string seal = io::hexadecimal(io::checksum(text));
    return text.append(before_seal).append(seal).append(after_seal);
}

bool seal_holds(std::string_view text)
{
    constexpr std::size_t digits = 32, length = before_seal.size() + digits + after_seal.size();
    if (text.size() < length) return false;
    const std::string_view content = text.substr(0, text.size() - length);
    return text.substr(content.size()) == std::string(before_seal) +
                                              io::hexadecimal(io::checksum(content)) +
                                              std::string(after_seal);
}

void Manifest::write(const RunFolder& folder, const std::string& status, const std::string& error)
{
    content_["status"] = status;
    if (status != "running") content_["ended"] = utc_now();
    if (!error.empty()) content_["error"] = error;
    content_["files_of_run"] = files_of_run(folder);
    io::write_file(folder.path() / manifest_name, with_seal(content_));
}

}
