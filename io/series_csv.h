// io/series_csv.h -- the time series as text: one line of comments with the units, one of names,
// then one row per sample. Numbers have as many digits as are needed to read back the same bits (at
// most 17). Every row is written at once, so the file can be watched while a run goes on. Errors:
// file, no_space; reading: missing, input (with the line number).
#pragma once
#include "engine/frame.h"
#include "io/appended_file.h"

#include <filesystem>
#include <vector>

namespace sigmaflow::io {

class SeriesWriter {
public:
    explicit SeriesWriter(const std::filesystem::path& path);
    /// Goes on behind the mark; rows after it are lost.
    SeriesWriter(const std::filesystem::path& path, const Mark& mark) : file_(path, mark) {}
    void append(const Sample& sample);
    /// Brings all rows to the disk.
    Mark mark() { return file_.mark(); }
    /// Brings the file to the disk and closes it.
    void finish() { file_.finish(); }

private:
    AppendedFile file_;
};

/// Reads a file of SeriesWriter; the columns must be those of sample_fields().
std::vector<Sample> read_series(const std::filesystem::path& path);

}
