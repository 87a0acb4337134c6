// tests/support/image_compare.cpp
#include "tests/support/image_compare.h"

#include "engine/error.h"

#include <filesystem>
#include <fstream>

namespace sigmaflow::test {
namespace {

std::string keep_candidate(const render::Image& image, const std::string& name)
{
    const auto folder = std::filesystem::current_path() / "image_candidates";
    std::filesystem::create_directories(folder);
    const auto path = folder / (name + ".png");
    std::ofstream(path, std::ios::binary) << render::png_bytes(image);
    return path.string();
}

}

testing::AssertionResult matches_baseline(const render::Image& image, const std::string& name,
                                          double least_similarity)
{
    const auto path = std::filesystem::path(SIGMAFLOW_TEST_IMAGES) / (name + ".png");
    render::Image baseline;
    try {
        baseline = render::read_png(path);
    } catch (const Error& error) {
        return testing::AssertionFailure()
               << "no baseline: " << error.what() << "; if the picture "
               << keep_candidate(image, name) << " is right, copy it to " << path;
    }
    const bool same_size = baseline.width == image.width && baseline.height == image.height;
    const double found = same_size ? similarity(image, baseline) : -1;
    if (found >= least_similarity) return testing::AssertionSuccess();
    return testing::AssertionFailure()
           << "the picture " << keep_candidate(image, name) << " differs from the baseline " << path
           << ": similarity " << found << ", at least " << least_similarity << " is asked for";
}

}
