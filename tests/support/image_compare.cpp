// tests/support/image_compare.cpp
#include "tests/support/image_compare.h"

#include "engine/error.h"
#include "tests/support/difference_page.h"

#include <cstdio>

namespace sigmaflow::test {
namespace {

/// Of all pixels; a plot without curves still has its axes, an empty picture nothing.
constexpr double least_drawn = 0.01;

std::string number(double value)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.4f", value);
    return text;
}

}

PictureFolders usual_folders()
{
    return {SIGMAFLOW_TEST_IMAGES, SIGMAFLOW_IMAGE_CANDIDATES};
}

testing::AssertionResult matches_baseline(const render::Image& image, const std::string& name,
                                          double least_similarity, const PictureFolders& folders)
{
    const auto path = folders.baselines / (name + ".png");
    Difference found{.name = name,
                     .accepted = path,
                     .drawn = image,
                     .baseline = {},
                     .score = 0,
                     .least = least_similarity,
                     .reason = ""};
    try {
        found.baseline = render::read_png(path);
    } catch (const Error& error) {
        found.reason = std::string("no baseline: ") + error.what();
    }
    if (found.baseline) {
        const bool same_size =
            found.baseline->width == image.width && found.baseline->height == image.height;
        if (same_size) found.score = similarity(image, *found.baseline);
        if (!same_size)
            found.reason = "another size than the baseline";
        else if (found.score < least_similarity)
            found.reason = "similarity " + number(found.score) + ", at least " +
                           number(least_similarity) + " is asked for";
    }
    if (const double drawn = drawn_share(image); drawn < least_drawn)
        found.reason = "blank: only " + number(drawn) + " of the pixels differ from the background";
    if (found.reason.empty()) {
        remove_difference(folders.candidates, name);
        return testing::AssertionSuccess();
    }
    const auto drawn = add_difference(folders.candidates, found);
    return testing::AssertionFailure()
           << name << ": " << found.reason << "; see " << folders.candidates / page_name
           << "; if the picture is right: cp " << drawn << " " << path;
}

}
