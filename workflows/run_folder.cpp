#include "workflows/run_folder.h"

#include "engine/error.h"
#include "io/atomic_file.h"
#include "io/json_document.h"
#include "workflows/folder_owner.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

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
    if (fs::is_directory(path, error)) return;
    fs::create_directories(path, error);
    if (error == std::errc::no_space_on_device)
        throw Error(ErrorKind::no_space, path.string(), "cannot make the folder: the disk is full");
    if (error || !fs::is_directory(path, error))
        refuse(path, "cannot make the folder" + (error ? ": " + error.message() : ""));
    io::sync_entry(path);
}

/// Who holds the lock: it has had time to write that down.
std::string owner_of(const fs::path& folder)
{
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    const std::string text = read_owner(folder).text;
    return text.empty() ? "another process" : text;
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
                        owner_of(path) + " is writing to this folder");
        refuse(path, std::string("cannot be locked: ") + std::strerror(reason));
    }
    return descriptor;
}

void require_same_workflow(const fs::path& folder, const std::string& workflow_name)
{
    const std::string mend = "; choose another folder with --out";
    if (!fs::is_directory(folder / own_folder))
        refuse(folder, "is not empty and holds no earlier run of sigmaflow" + mend);
    if (!fs::exists(folder / manifest_name)) return;  // ended before it was written
    std::string name;
    try {
        const auto document = io::JsonDocument::read(folder / manifest_name);
        document.root().member("sigmaflow");
        name = document.root().member("workflow").member("name").text();
    } catch (const Error&) {
        refuse(folder, "is not empty and its manifest.json is not one of sigmaflow" + mend);
    }
    if (name != workflow_name)
        refuse(folder, "holds a run of another workflow, " + io::in_quotes(name) + mend);
}

/// A link inside the folder would lead the output to another place.
void refuse_links(const fs::path& folder, const fs::path& relative)
{
    fs::path path = folder;
    for (const fs::path& part : relative) {
        path /= part;
        std::error_code ignored;
        if (fs::is_symlink(fs::symlink_status(path, ignored)))
            refuse(path, "is a symbolic link: results are written inside their folder only");
    }
}

bool is_frame_file(const std::string& name)
{
    for (const std::string kind : {"particles_", "contacts_"})
        if (name.starts_with(kind) && (name.ends_with(".vtp") || name.ends_with(".vtp.tmp")))
            return true;
    return false;
}

}

bool is_inside(const fs::path& relative)
{
    return !relative.empty() && relative.is_relative() &&
           std::none_of(relative.begin(), relative.end(),
                        [](const fs::path& part) { return part == ".." || part.empty(); });
}

RunFolder::RunFolder(fs::path path, const std::string& workflow_name) : path_(std::move(path))
{
    std::error_code ignored;
    if (fs::exists(path_, ignored) && !fs::is_directory(path_, ignored))
        refuse(path_, "is not a folder");
    make_folder(path_);
    lock_ = lock_folder(path_);
    try {
        if (!fs::is_empty(path_)) require_same_workflow(path_, workflow_name);
        refuse_links(path_, own_folder);
        make_folder(path_ / own_folder);
        write_owner(path_);
        for (const auto& entry : fs::directory_iterator(path_ / own_folder))
            if (entry.path().extension() == ".tmp") fs::remove(entry.path(), ignored);
    } catch (const fs::filesystem_error& error) {
        ::close(lock_);
        refuse(path_, error.code().message());
    } catch (...) {
        ::close(lock_);
        throw;
    }
}

RunFolder::RunFolder(fs::path path) : path_(std::move(path)) {}

RunFolder RunFolder::to_read(const fs::path& path)
{
    return RunFolder(path);
}

RunFolder::~RunFolder()
{
    if (lock_ >= 0) ::close(lock_);
}

fs::path RunFolder::file(const std::string& relative)
{
    refuse_links(path_, fs::path(relative).parent_path());
    const fs::path result = path_ / relative;
    make_folder(result.parent_path());
    if (std::find(announced_.begin(), announced_.end(), relative) == announced_.end())
        announced_.push_back(relative);
    return result;
}

fs::path RunFolder::own_file(const std::string& name) const
{
    return path_ / own_folder / name;
}

std::vector<ResultFile> RunFolder::take_results()
{
    std::vector<ResultFile> result;
    for (const std::string& name : announced_) {
        std::error_code error;
        const auto size = fs::file_size(path_ / name, error);
        if (!error) result.push_back({name, size, io::file_checksum(path_ / name)});
    }
    announced_.clear();
    return result;
}

std::string RunFolder::difference(const ResultFile& file) const
{
    std::error_code error;
    if (!is_inside(file.name) || !fs::is_regular_file(path_ / file.name, error))
        return file.name + " is missing";
    if (fs::file_size(path_ / file.name, error) != file.size || error ||
        io::file_checksum(path_ / file.name) != file.digest)
        return file.name + " was changed";
    return "";
}

void RunFolder::remove(const std::string& relative) const
{
    std::error_code ignored;
    if (is_inside(relative)) fs::remove(path_ / relative, ignored);
}

void RunFolder::remove_leftovers(const std::string& step) const
{
    for (const std::string name : {series_name, run_name, journal_name, state_name, failure_name,
                                   "particles.pvd", "contacts.pvd", "view.py"})
        for (const char* ending : {"", ".tmp", ".part"}) remove(step + "/" + name + ending);
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(path_ / step / "vtk", error))
        if (const std::string name = entry.path().filename(); is_frame_file(name))
            remove(step + "/vtk/" + name);
}

}
