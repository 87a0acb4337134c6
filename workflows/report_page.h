// workflows/report_page.h -- one page that tells what a run has found: sigmaflow report DIR.
//
// HTML5 that an XML parser reads, too. It needs no other file: pictures are inside (SVG where there
// is one, otherwise PNG), there is no script. Pictures are embedded as images, so nothing in them
// can act on the page, and their names cannot clash. The same folder gives the same bytes.
#pragma once
#include "workflows/past_run.h"

#include <filesystem>
#include <string>

namespace sigmaflow::workflows {

/// `to_folder`: from the page to the folder of the run, empty or ending with /. Errors: missing (a
/// picture cannot be read), input (a picture is none).
std::string report_page(const PastRun& run, const std::string& to_folder);

/// Reads the folder, writes the page to `out` or to report.html in the folder, atomically, and
/// returns its path. Errors: those of past_run.h and report_page; usage (`out` is a result of the
/// run), file, no_space.
std::filesystem::path write_report_page(const std::filesystem::path& folder,
                                        const std::filesystem::path& out);

}
