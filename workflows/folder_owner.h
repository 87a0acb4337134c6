// workflows/folder_owner.h -- who writes, or wrote last, to the folder of a run.
//
// .sigmaflow/owner has a line "process 4711 on host" and a line with its checksum. It outlives its
// process; whether somebody writes now is asked of the kernel (/proc/locks), without taking a lock.
// Errors of writing: file, no_space.
#pragma once
#include <filesystem>
#include <string>

namespace sigmaflow::workflows {

struct FolderOwner {
    std::string text;  // "process 4711 on host"; empty: nobody, or not readable
    int process = 0;
    std::string host;
    bool whole = true;  // false: the file was changed
};

void write_owner(const std::filesystem::path& folder);
FolderOwner read_owner(const std::filesystem::path& folder);

/// no; yes; unknown: the owner is on another host.
enum class Writing { no, yes, unknown };
Writing is_written(const std::filesystem::path& folder);

/// Error(locked) if somebody writes to the folder now.
void require_no_writer(const std::filesystem::path& folder);

}
