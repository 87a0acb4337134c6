// io/run_file.h -- the HDF5 file of one shearing step (schema: io/README.md).
//
// Time series of every scalar, H5MD-style particle frames, units as attributes, provenance.
// The file grows under the name "<path>.part" and gets its own name when finished, so a file called
// run.h5 is always complete; what a broken run leaves is readable up to the last flush.
// Errors: file, no_space; reading: missing, input (not a finished sigmaflow file, or a damaged
// one); they name the file and the dataset. After an Error a RunWriter can only be destroyed.
#pragma once
#include "engine/frame.h"
#include "engine/model.h"

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace sigmaflow::io {

/// Texts stored as attributes of the group /provenance, e.g. version, seed, resolved workflow.
using Provenance = std::map<std::string, std::string>;

class RunWriter {
public:
    /// `first` says which particles the frames will have, at least one; it is not stored as a
    /// frame.
    RunWriter(const std::filesystem::path& path, const State& first, const Model& model,
              const Control& control, const Provenance& provenance);
    ~RunWriter();
    RunWriter(RunWriter&&) noexcept;

    /// Samples and frames come in the order of their times.
    void append(const Sample& sample);
    /// Error(internal) if the particles are not those of the first state.
    void append(const Frame& frame);
    /// Hands everything to the operating system.
    void flush();
    /// Completes the file and gives it its name.
    void finish();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

struct StoredRun {
    std::vector<Sample> series;
    std::vector<Frame> frames;  // their states are complete: a run can be continued from each
    Model model;
    Control control;
    Provenance provenance;
};

/// Reads a finished run back; every number bitwise as it was written.
StoredRun read_run(const std::filesystem::path& path);

struct RunSummary {
    std::size_t samples = 0, frames = 0, particles = 0;
    Control control;
    double strain = 0;           // of the last frame [-]
    double volume_fraction = 0;  // of the first frame [-]
    double narrowest_box = 0;    // likewise [a]
    double largest_radius = 0;   // [a]
};

template <class Archive>
void archive(Archive& a, RunSummary& s)
{
    a(s.samples, s.frames, s.particles, s.control, s.strain, s.volume_fraction, s.narrowest_box,
      s.largest_radius);
}

/// Checks all that read_run checks, and that boxes and positions are finite, without taking the run
/// into memory: about a megabyte, or one frame of one array, at a time.
RunSummary check_run(const std::filesystem::path& path);

}
