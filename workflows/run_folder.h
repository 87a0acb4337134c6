// workflows/run_folder.h -- the folder that a run of a workflow writes to.
//
// A folder is used if it does not exist, is empty, or is one of the same workflow: it has a folder
// .sigmaflow, and a manifest.json (if it has one) with that name. Any other folder is refused.
// While a run works on a folder, other processes are kept out by a lock of the kernel on the
// folder, which ends with the process, however that ends; .sigmaflow/owner only says who holds it.
// Nothing is ever written through a symbolic link inside the folder. Errors: file (not a usable
// folder), no_space, locked.
#pragma once
#include "io/checksum.h"

#include <filesystem>
#include <string>
#include <vector>

namespace sigmaflow::workflows {

inline constexpr const char* manifest_name = "manifest.json";
inline constexpr const char* summary_name = "summary.json";
inline constexpr const char* resolved_name = "resolved.json";
inline constexpr const char* own_folder = ".sigmaflow";

/// A file of a run, by its name relative to the folder.
struct ResultFile {
    std::string name;
    std::uint64_t size = 0;
    io::Digest digest{};
};

template <class Archive>
void archive(Archive& a, ResultFile& file)
{
    a(file.name, file.size, file.digest);
}

/// Does a name that was read from a file lead to a place inside the folder? Only then it is used.
bool is_inside(const std::filesystem::path& relative);

class RunFolder {
public:
    RunFolder(std::filesystem::path path, const std::string& workflow_name);
    /// A folder to look at, of any kind or not there: no lock is taken, nothing is made.
    static RunFolder to_read(const std::filesystem::path& path);
    ~RunFolder();
    RunFolder(const RunFolder&) = delete;
    RunFolder& operator=(const RunFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }

    /// Path of a result that the running step writes; its parent folders are made.
    std::filesystem::path file(const std::string& relative);
    /// Path of a file that is no result, in .sigmaflow.
    std::filesystem::path own_file(const std::string& name) const;
    /// The results announced by file() since the last call, with sizes and checksums.
    std::vector<ResultFile> take_results();

    /// Empty if the file is what it was, otherwise "shear/run.h5 is missing", "... was changed".
    std::string difference(const ResultFile& file) const;
    /// Removes a file of an earlier run; names that lead out of the folder are left alone.
    void remove(const std::string& relative) const;
    /// Removes everything that a shearing step of this name may have left behind.
    void remove_leftovers(const std::string& step) const;

private:
    explicit RunFolder(std::filesystem::path path);

    std::filesystem::path path_;
    std::vector<std::string> announced_;
    int lock_ = -1;
};

/// The files of a shearing step, relative to its folder (workflows/run_files.h), and those of
/// frames, which have a number.
inline constexpr const char* series_name = "series.csv";
inline constexpr const char* run_name = "run.h5";
inline constexpr const char* journal_name = "run.journal";
inline constexpr const char* state_name = "state.json";
inline constexpr const char* failure_name = "failure.json";

}
