// workflows/verification.h -- is everything in the folder of a run what the run has written?
//
// Compared are
//   - every file that manifest.json or the record of a finished step lists: size and checksum
//   - manifest.json with its own seal; summary.json and resolved.json with their checksums in it
//   - .sigmaflow/: records, checkpoints and parts with their seals, the growing files of an
//     interrupted step up to the mark of the checkpoint, the line that names the owner
// Files that nothing lists are named, but they are no fault: nobody knows what they should be.
// Of a run that was killed the records alone say what is finished.
// Errors: missing (no such folder), input (not the folder of a run), locked (a run is writing).
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace sigmaflow::workflows {

struct Fault {
    std::string file;     // relative to the folder
    std::string problem;  // "is missing", "was changed", ...
};

struct Verification {
    std::string status;         // of the run, "unknown" if the manifest cannot be read
    std::size_t files = 0;      // that were compared
    std::uint64_t bytes = 0;    // in them
    std::vector<Fault> faults;  // at most one for a file
    std::vector<std::string> unlisted;
};

Verification verify_folder(const std::filesystem::path& folder);

}
