// tests/support/difference_page.h -- the page that shows pictures which are not what they were.
//
// Every comparison that fails leaves <name>.png (what was drawn) and <name>.row in a folder; the
// page differences.html beside them is made of all rows: baseline, drawn, difference, score. It is
// whole in itself (pictures are inside, no script), and tests may run side by side. A comparison
// that succeeds takes its row away; without rows there is no page.
#pragma once
#include "render/image.h"

#include <filesystem>
#include <optional>
#include <string>

namespace sigmaflow::test {

inline constexpr const char* page_name = "differences.html";

struct Difference {
    std::string name;
    std::filesystem::path accepted;  // where the baseline is, or should be
    render::Image drawn;
    std::optional<render::Image> baseline;
    double score = 0, least = 1;
    std::string reason;  // "similarity 0.5, at least 0.9 is asked for"
};

/// White where two pictures of equal size are the same, the darker red the more they differ.
render::Image difference_of(const render::Image& a, const render::Image& b);

/// Returns the path of what was drawn.
std::filesystem::path add_difference(const std::filesystem::path& folder, const Difference& found);
void remove_difference(const std::filesystem::path& folder, const std::string& name);

}
