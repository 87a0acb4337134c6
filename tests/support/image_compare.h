// tests/support/image_compare.h -- pictures against those that people have looked at.
#pragma once
#include "render/image.h"
#include "tests/support/similarity.h"

#include <gtest/gtest.h>
#include <string>

namespace sigmaflow::test {

/// Compares with tests/images/<name>.png. If that is missing or not similar enough, the picture is
/// left in image_candidates/<name>.png of the working folder and the message names both.
testing::AssertionResult matches_baseline(const render::Image& image, const std::string& name,
                                          double least_similarity);

}
