// workflows/doctor.h -- does this machine have what runs need? One line for each thing, and the
// mend for what is missing.
//
// Pictures, fonts, HDF5 and VTK are tried in child processes (io/guarded.h), which a broken library
// may take down. What only judges a fact is a function of that fact, so that it can be asked about
// machines that are not at hand.
#pragma once
#include "engine/error.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sigmaflow::workflows {

struct Finding {
    enum class Level { ok, info, warn, fail };

    std::string name;  // "pictures", "folder", ...
    Level level = Level::ok;
    std::string text, mend;                 // what was found; what to do
    ErrorKind kind = ErrorKind::rendering;  // exit code if it fails
};

std::string_view level_name(Finding::Level level);

/// All checks; what runs write is tried in `folder`, which must exist.
std::vector<Finding> examine(const std::filesystem::path& folder);

// judgements
Finding judge_instructions(const std::string& arithmetic);
Finding judge_blas(const std::string& kernel);
/// Memory [B] that is left, nothing: unknown, and what limits it.
Finding judge_memory(const std::optional<double>& memory, const std::string& limit);
Finding judge_threads(int cores, int usable, const std::optional<double>& quota);
/// Seconds since 1970 of this machine, and by how much the file system is ahead of it.
Finding judge_clock(double now, double file_system_ahead);

// checks of the machine (doctor_checks.cpp)
Finding examine_pictures();
Finding examine_fonts();
Finding examine_hdf5(const std::filesystem::path& folder);
Finding examine_vtk(const std::filesystem::path& folder);
Finding examine_folder(const std::filesystem::path& folder);
Finding examine_lock(const std::filesystem::path& folder);
Finding examine_locale();

}
