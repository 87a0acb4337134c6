// io/run_journal.h -- what a running step has recorded so far, in the order in which it came.
//
// HDF5 files that are written to do not survive a kill, so a running step appends its samples and
// frames to this file, which can be cut back to a mark, and run.h5 is made of it at the end.
// Errors: file, no_space; reading: missing, input.
#pragma once
#include "engine/frame.h"
#include "io/appended_file.h"

#include <filesystem>
#include <functional>

namespace sigmaflow::io {

class RunJournal {
public:
    explicit RunJournal(const std::filesystem::path& path) : file_(path) {}
    /// Goes on behind the mark.
    RunJournal(const std::filesystem::path& path, const Mark& mark) : file_(path, mark) {}

    /// `on_grid`: at a multiple of the series interval.
    void append(const Sample& sample, bool on_grid);
    void append(const Frame& frame);
    /// Brings all entries to the disk.
    Mark mark() { return file_.mark(); }
    void finish() { file_.finish(); }

private:
    AppendedFile file_;
};

struct JournalVisitor {
    std::function<void(const Sample&, bool on_grid)> sample;
    std::function<void(const Frame&)> frame;
};

/// One entry after the other; the journal may be larger than the memory.
void read_journal(const std::filesystem::path& path, const JournalVisitor& visitor);

/// The same for the journal of a step that may be running or was killed: an entry that is cut at
/// the end is not there yet.
void read_journal_so_far(const std::filesystem::path& path, const JournalVisitor& visitor);

}
