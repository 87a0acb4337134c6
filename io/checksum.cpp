#include "io/checksum.h"

#include "io/atomic_file.h"

#include <cstdio>
#include <limits>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace sigmaflow::io {

struct Checksum::State {
    XXH3_state_t xxh;
};

Checksum::Checksum() : state_(std::make_unique<State>())
{
    XXH3_128bits_reset(&state_->xxh);
}
Checksum::~Checksum() = default;
Checksum::Checksum(Checksum&&) noexcept = default;

void Checksum::add(std::string_view bytes)
{
    XXH3_128bits_update(&state_->xxh, bytes.data(), bytes.size());
}

Digest Checksum::digest() const
{
    const XXH128_hash_t hash = XXH3_128bits_digest(&state_->xxh);
    return {hash.low64, hash.high64};
}

Digest checksum(std::string_view bytes)
{
    const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
    return {hash.low64, hash.high64};
}

Digest file_checksum(const std::filesystem::path& path)
{
    Checksum sum;
    read_pieces(path, std::numeric_limits<std::uint64_t>::max(),
                [&](std::string_view piece) { sum.add(piece); });
    return sum.digest();
}

std::string hexadecimal(const Digest& digest)
{
    char text[40];
    std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(digest[1]),
                  static_cast<unsigned long long>(digest[0]));
    return text;
}

}
