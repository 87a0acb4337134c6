// io/atomic_file.h -- text files that are either complete or not there, and system errors as
// Errors.
//
// write_file writes "<path>.tmp", brings it to the disk (fsync), renames it and syncs the folder:
// after a crash or a full disk the old file is still there, whole. What is not a regular file
// (/dev/stdout) is written directly. Errors carry the path and the reason given by the system:
// no_space (disk or quota full, file size limit), file (anything else that cannot be written),
// missing (cannot be read, or not a regular file), input (too large).
//
// Reading waits for nobody and believes nobody: folders, devices and pipes are refused before they
// are opened, and the size is checked before anything is read.
#pragma once
#include "engine/error.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace sigmaflow::io {

inline constexpr std::size_t largest_text_file = std::size_t{64} << 20;  // 64 MiB

void write_file(const std::filesystem::path& path, std::string_view text);

/// The whole file; Error(input) if it has more than `largest` bytes.
std::string read_file(const std::filesystem::path& path, std::size_t largest = largest_text_file);

/// The first bytes of a file of any size, fewer if it is shorter.
std::string first_bytes(const std::filesystem::path& path, std::size_t count);

/// Gives a complete file its name: fsync, rename, fsync of the folder.
void commit_file(const std::filesystem::path& temporary, const std::filesystem::path& path);

/// Brings the entry of a new file or folder in its folder to the disk.
void sync_entry(const std::filesystem::path& path);

/// The Error of a failed write with the system's error number.
Error write_error(const std::filesystem::path& path, int error_number);

/// Reads at most `size` bytes, piece by piece. Errors: missing.
void read_pieces(const std::filesystem::path& path, std::uint64_t size,
                 const std::function<void(std::string_view)>& take);

/// A file open for writing, unbuffered: what was written can be read by others. A link in its place
/// is refused: it would lead the output elsewhere.
class OutputFile {
public:
    /// A new file; an older one is lost.
    explicit OutputFile(std::filesystem::path path);
    /// An existing file, cut to `size` bytes; writing goes on there.
    OutputFile(std::filesystem::path path, std::uint64_t size);
    ~OutputFile();
    OutputFile(OutputFile&& other) noexcept;
    OutputFile& operator=(OutputFile&&) = delete;

    void write(std::string_view text);
    void sync();
    void close();

private:
    std::filesystem::path path_;
    int descriptor_ = -1;
};

}
