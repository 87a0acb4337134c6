// workflows/run_folder.h -- the folder that a run of a workflow writes to.
//
// A folder is used if it does not exist, is empty, or holds an earlier run of the same workflow (it
// has a manifest.json of sigmaflow with that name); the files of the earlier run are then removed
// first, and only those that its manifest lists. Any other folder is refused. While a run works on
// a folder, other processes are kept out by a lock of the kernel, which ends with the process.
// Errors: file (not a usable folder), no_space, locked.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace sigmaflow::workflows {

inline constexpr const char* manifest_name = "manifest.json";
inline constexpr const char* summary_name = "summary.json";

class RunFolder {
public:
    RunFolder(std::filesystem::path path, const std::string& workflow_name);
    ~RunFolder();
    RunFolder(const RunFolder&) = delete;
    RunFolder& operator=(const RunFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    bool replaces_earlier_run() const { return replaces_; }

    /// Path of a file to be written, relative to the folder; its parent folders are made and the
    /// file is listed in the manifest.
    std::filesystem::path file(const std::string& relative);

    struct Entry {
        std::string name;  // relative to the folder
        std::uintmax_t size = 0;
    };
    /// The announced files that exist, in the order of announcement.
    std::vector<Entry> files() const;

private:
    std::filesystem::path path_;
    std::vector<std::string> announced_;
    bool replaces_ = false;
    int lock_ = -1;
};

}
