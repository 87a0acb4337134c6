// io/checksum.h -- 128 bits that tell whether bytes have changed (XXH3 of xxHash by Y. Collet).
//
// Against accidents (bit flips, cut files, edited results), not against forgery.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace sigmaflow::io {

using Digest = std::array<std::uint64_t, 2>;

/// Of bytes that come in pieces.
class Checksum {
public:
    Checksum();
    ~Checksum();
    Checksum(Checksum&&) noexcept;

    void add(std::string_view bytes);
    /// Of all bytes so far.
    Digest digest() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

Digest checksum(std::string_view bytes);

/// Of a whole file, read in pieces. Errors: missing (cannot be read).
Digest file_checksum(const std::filesystem::path& path);

/// 32 hexadecimal digits.
std::string hexadecimal(const Digest& digest);

}
