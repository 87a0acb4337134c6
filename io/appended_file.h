// io/appended_file.h -- a file that only grows and can be cut back to a marked length.
//
// A mark says how long the file was and what was in it. Whoever keeps marks (a checkpoint) can go
// on after any accident: the file is verified up to the mark and cut there. What was written is
// with the operating system at once (unbuffered), and on the disk when `mark` returns.
// Errors: file, no_space; input (not what was marked).
#pragma once
#include "io/atomic_file.h"
#include "io/checksum.h"

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace sigmaflow::io {

struct Mark {
    std::uint64_t size = 0;  // [bytes]
    Digest digest{};         // of the first `size` bytes
};

template <class Archive>
void archive(Archive& a, Mark& mark)
{
    a(mark.size, mark.digest);
}

/// The checksum of the first `size` bytes; Error(input) if there are fewer or they are not those
/// of the mark.
Checksum verify(const std::filesystem::path& path, const Mark& mark);

class AppendedFile {
public:
    /// A new file; an older one is lost.
    explicit AppendedFile(const std::filesystem::path& path);
    /// Goes on behind the mark; what comes after it in the file is lost.
    AppendedFile(const std::filesystem::path& path, const Mark& mark);

    void write(std::string_view bytes);
    /// Brings everything to the disk.
    Mark mark();
    /// Brings everything to the disk and closes the file.
    void finish();

private:
    Checksum sum_;  // verified before the file is cut
    OutputFile file_;
    std::uint64_t size_ = 0;
};

}
