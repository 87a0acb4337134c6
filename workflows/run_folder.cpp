#include "workflows/run_folder.h"

#include "engine/error.h"
#include "io/json_document.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstring>

namespace sigmaflow::workflows {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void refuse(const fs::path& path, const std::string& problem)
{
    throw Error(ErrorKind::file, path.string(), problem);
}

void make_folder(const fs::path& path)
{
    std::error_code error;
    fs::create_directories(path, error);
    if (error == std::errc::no_space_on_device)
        throw Error(ErrorKind::no_space, path.string(), "cannot make the folder: the disk is full");
    if (error || !fs::is_directory(path, error))
        refuse(path, "cannot make the folder" + (error ? ": " + error.message() : ""));
}

int lock_folder(const fs::path& path)
{
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) refuse(path, std::string("cannot be opened: ") + std::strerror(errno));
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
        const int reason = errno;
        ::close(descriptor);
        if (reason == EWOULDBLOCK)
            throw Error(ErrorKind::locked, path.string(),
                        "another sigmaflow is writing to this folder");
        refuse(path, std::string("cannot be locked: ") + std::strerror(reason));
    }
    return descriptor;
}

/// A manifest is only trusted to name files inside its own folder.
bool is_inside(const fs::path& relative)
{
    return !relative.empty() && relative.is_relative() &&
           std::none_of(relative.begin(), relative.end(),
                        [](const fs::path& part) { return part == ".." || part.empty(); });
}

/// Files of the earlier run in the folder; an error if it was not one of this workflow.
std::vector<fs::path> earlier_files(const fs::path& folder, const std::string& workflow_name)
{
    const std::string mend = "; choose another folder with --out";
    const fs::path manifest = folder / manifest_name;
    if (!fs::exists(manifest))
        refuse(folder, "is not empty and holds no earlier run of sigmaflow" + mend);
    std::vector<fs::path> files;
    try {
        const auto document = io::JsonDocument::read(manifest);
        const io::JsonNode root = document.root();
        root.member("sigmaflow");
        const std::string name = root.member("workflow").member("name").text();
        if (name != workflow_name)
            refuse(folder, "holds a run of another workflow, " + io::in_quotes(name) + mend);
        for (const io::JsonNode& file : root.member("files").elements())
            files.emplace_back(file.member("name").text());
    } catch (const Error& error) {
        if (error.kind() == ErrorKind::file) throw;
        refuse(folder, "is not empty and its manifest.json is not one of sigmaflow" + mend);
    }
    return files;
}

}

RunFolder::RunFolder(fs::path path, const std::string& workflow_name) : path_(std::move(path))
{
    std::error_code ignored;
    if (fs::exists(path_, ignored) && !fs::is_directory(path_, ignored))
        refuse(path_, "is not a folder");
    make_folder(path_);
    lock_ = lock_folder(path_);
    try {
        if (fs::is_empty(path_)) return;
        for (const fs::path& file : earlier_files(path_, workflow_name))
            if (is_inside(file)) fs::remove(path_ / file, ignored);
        replaces_ = true;
    } catch (const fs::filesystem_error& error) {
        ::close(lock_);
        refuse(path_, error.code().message());
    } catch (...) {
        ::close(lock_);
        throw;
    }
}

RunFolder::~RunFolder()
{
    ::close(lock_);
}

fs::path RunFolder::file(const std::string& relative)
{
    const fs::path result = path_ / relative;
    make_folder(result.parent_path());
    if (std::find(announced_.begin(), announced_.end(), relative) == announced_.end())
        announced_.push_back(relative);
    return result;
}

std::vector<RunFolder::Entry> RunFolder::files() const
{
    std::vector<Entry> result;
    for (const std::string& name : announced_) {
        std::error_code error;
        const auto size = fs::file_size(path_ / name, error);
        if (!error) result.push_back({name, size});
    }
    return result;
}

}
