// tests/render/offscreen_test.cpp -- pictures without a display, and a clean refusal without a
// driver.
//
// Each case runs render_probe, because a process reads its graphics environment only once.
#include "render/offscreen.h"
#include "engine/error.h"
#include "render/image.h"
#include "tests/render/svg_reader.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <vtkRenderWindow.h>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>

using namespace sigmaflow;

namespace {

struct Outcome {
    int exit_code;  // -1: ended by a signal
    std::string output, error_output;
};

Outcome probe(const std::string& environment, const std::string& what)
{
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    const std::string errors = testing::TempDir() + "sigmaflow_probe_" + test->name() + ".txt";
    const std::string command =
        "env " + environment + " '" SIGMAFLOW_RENDER_PROBE "' " + what + " 2>'" + errors + "'";
    Outcome outcome{};
    std::FILE* pipe = popen(command.c_str(), "r");
    std::array<char, 4096> block;
    while (const std::size_t count = std::fread(block.data(), 1, block.size(), pipe))
        outcome.output.append(block.data(), count);
    const int status = pclose(pipe);
    outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    std::ifstream file(errors);
    outcome.error_output.assign(std::istreambuf_iterator<char>(file), {});
    std::filesystem::remove(errors);
    return outcome;
}

const std::string no_driver = "__EGL_VENDOR_LIBRARY_FILENAMES=/dev/null";

}

TEST(Offscreen, IsAvailableHere)
{
    EXPECT_EQ(render::why_unavailable(), "");
}

TEST(Offscreen, NeedsNoDisplayAndNoHome)
{
    for (const std::string environment :
         {"-u DISPLAY -u WAYLAND_DISPLAY", "DISPLAY=:987", "DISPLAY=nowhere:0",
          "-u DISPLAY -u HOME -u XDG_RUNTIME_DIR", "HOME=/nonexistent"}) {
        const Outcome outcome = probe(environment, "particles");
        EXPECT_EQ(outcome.exit_code, 0) << environment << ": " << outcome.output;
        EXPECT_EQ(outcome.error_output, "") << environment;
    }
}

TEST(Offscreen, WithoutADriverPicturesFailCleanlyAndNameThePackage)
{
    const Outcome outcome = probe(no_driver, "particles");
    EXPECT_EQ(outcome.exit_code, static_cast<int>(ErrorKind::rendering));
    EXPECT_NE(outcome.output.find("libgl1-mesa-dri"), std::string::npos) << outcome.output;
    EXPECT_EQ(outcome.error_output, "");
}

TEST(Offscreen, WithoutADriverTheReasonIsToldInsteadOfThrown)
{
    const Outcome outcome = probe(no_driver, "why");
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_NE(outcome.output.find("libegl1"), std::string::npos) << outcome.output;
}

TEST(Offscreen, WithoutADriverPlotsAreStillDrawn)
{
    EXPECT_EQ(probe(no_driver, "plot").exit_code, 0);
    const Outcome svg = probe(no_driver, "svg");
    EXPECT_EQ(svg.exit_code, 0);
    EXPECT_TRUE(test::read_svg(svg.output).well_formed);
}

TEST(Offscreen, IsWhatVtkUsesForEveryWindowFromThenOn)
{
    const auto ours = render::make_offscreen_window(20, 10);
    const auto theirs = vtkSmartPointer<vtkRenderWindow>::New();
    EXPECT_STREQ(theirs->GetClassName(), ours->GetClassName());
}

TEST(Offscreen, WindowsOfDifferentSizesLiveSideBySide)
{
    const auto first = render::make_offscreen_window(40, 30);
    const auto second = render::make_offscreen_window(25, 15);
    first->Render();
    second->Render();
    const render::Image a = render::read_pixels(first), b = render::read_pixels(second);
    EXPECT_EQ(a.width * 1000 + a.height, 40030);
    EXPECT_EQ(b.width * 1000 + b.height, 25015);
}
