// tests/support/image_compare.h -- pictures against those that people have looked at.
#pragma once
#include "render/image.h"
#include "tests/support/similarity.h"

#include <gtest/gtest.h>
#include <filesystem>
#include <string>

namespace sigmaflow::test {

/// Where baselines lie, and where pictures that differ are left with their page.
struct PictureFolders {
    std::filesystem::path baselines, candidates;
};
/// tests/images, and image_candidates in the build folder.
PictureFolders usual_folders();

/// Compares with <baselines>/<name>.png. Fails if that is missing or not similar enough, or if the
/// picture is blank, whatever the baseline; then the picture is left in the folder of candidates,
/// the page there shows it (difference_page.h), and the message names all three.
testing::AssertionResult matches_baseline(const render::Image& image, const std::string& name,
                                          double least_similarity,
                                          const PictureFolders& folders = usual_folders());

}
