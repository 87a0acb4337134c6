// engine/random.h -- counter-based random numbers: a pure function of (seed, stream, counter).
//
// Philox4x32-10, Salmon, Moraes, Dror & Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC'11.
// No state to save or to get out of step. Tested with the known answers published with Random123.
#pragma once
#include <array>
#include <cstdint>

namespace sigmaflow {

using Philox = std::array<std::uint32_t, 4>;

constexpr Philox philox(Philox counter, std::array<std::uint32_t, 2> key)
{
    for (int round = 0; round < 10; ++round) {
        const std::uint64_t p = std::uint64_t{0xD2511F53} * counter[0];
        const std::uint64_t q = std::uint64_t{0xCD9E8D57} * counter[2];
        counter = {static_cast<std::uint32_t>(q >> 32) ^ counter[1] ^ key[0],
                   static_cast<std::uint32_t>(q),
                   static_cast<std::uint32_t>(p >> 32) ^ counter[3] ^ key[1],
                   static_cast<std::uint32_t>(p)};
        key[0] += 0x9E3779B9;
        key[1] += 0xBB67AE85;
    }
    return counter;
}

/// Uniform double in [0, 1) with 53 random bits.
constexpr double uniform(std::uint64_t seed, std::uint32_t stream, std::uint64_t counter)
{
    const Philox r = philox(
        {static_cast<std::uint32_t>(counter), static_cast<std::uint32_t>(counter >> 32), stream, 0},
        {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)});
    const std::uint64_t bits = (std::uint64_t{r[1]} << 32 | r[0]) >> 11;
    return static_cast<double>(bits) * 0x1p-53;
}

/// A seed below 2^53 made from another one.
constexpr std::uint64_t derived_seed(std::uint64_t seed, std::uint32_t stream,
                                     std::uint64_t counter)
{
    return static_cast<std::uint64_t>(uniform(seed, stream, counter) * 0x1p53);
}

}
