// io/sealed_file.h -- a file of bytes that knows its kind and notices every change.
//
// "sigmaflow sealed file", kind, version, length, the bytes, and a checksum of all that. Written
// atomically (io/atomic_file.h). Errors: file, no_space; reading: missing, input (another kind or
// version, cut, changed).
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace sigmaflow::io {

struct Seal {
    std::string_view kind;  // e.g. "checkpoint"
    std::uint32_t version = 1;
};

void write_sealed(const std::filesystem::path& path, const Seal& seal, std::string_view bytes);
std::string read_sealed(const std::filesystem::path& path, const Seal& seal);
/// The whole file; one that is not sealed is refused before it is read.
std::string sealed_content(const std::filesystem::path& path);

/// Error(input) if the bytes of a sealed file of any kind are not those that were written.
void check_seal(std::string_view file_content, const std::string& file);

/// The same in memory; `file` stands for the file in error messages.
std::string sealed(const Seal& seal, std::string_view bytes);
std::string unsealed(std::string_view file_content, const Seal& seal, const std::string& file);

}
