// tests/io/random_frame.h -- frames full of random numbers and of the awkward ones (-0, denormals,
// infinities), and their comparison bit by bit. The numbers are not meant to be physics.
#pragma once
#include "engine/frame.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace sigmaflow::testing_io {

/// VTK's reader refuses vectors with an infinite norm.
enum class Extremes { any_double, finite_norm };

/// `contacts` <= particles - 1 touching pairs.
Frame random_frame(int particles, int contacts, unsigned seed,
                   Extremes extremes = Extremes::any_double);
Sample random_sample(unsigned seed);

/// The bits of every number, in a fixed order: two objects are equal if their fingerprints are.
using Bits = std::vector<std::uint64_t>;
Bits bits(const Sample& sample);
Bits bits(const State& state);
Bits bits(const Frame& frame);

/// An empty folder of its own for every test, removed at the end.
class TemporaryFolder {
public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    /// Names of all files in the folder, sorted.
    std::vector<std::string> files() const;

private:
    std::filesystem::path path_;
};

}
