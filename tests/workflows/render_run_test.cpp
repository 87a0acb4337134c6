// New pictures of stored runs: the same as the run itself would have drawn, and nothing of the run
// is touched.
#include "workflows/render_run.h"

#include "io/run_file.h"
#include "io/run_journal.h"
#include "tests/workflows/program.h"
#include "workflows/commands.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#include <CLI/CLI.hpp>
#include <map>

namespace sigmaflow::workflows {

namespace {

namespace fs = std::filesystem;

constexpr const char* flow = R"({
  "suspension": {"particles": 30, "volume_fraction": 0.4, "size_ratio": 1.4, "seed": 3},
  "steps": [
    {"step": "pack"},
    {"step": "equilibrate", "stress": 2, "minimum_strain": 0.1, "maximum_strain": 0.1,
     "window": 0.05, "series_interval": 0.01},
    {"step": "shear", "stress": 2, "strain": 0.3, "frame_interval": 0.1},
    {"step": "snapshot", "strain": 0.2, "width": 240, "height": 180},
    {"step": "snapshot", "name": "cut", "colour_by": "contact_number", "view": "front", "clip": "z=3",
     "zoom": 1.5, "width": 240, "height": 180},
    {"step": "snapshot", "name": "nothing", "clip": "x=-9", "width": 240, "height": 180}
  ]
})";

/// Every file below a folder but those in its folder for pictures.
std::map<std::string, std::string> content(const fs::path& folder)
{
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const std::string name = fs::relative(entry.path(), folder).string();
        if (entry.is_regular_file() && !name.starts_with("render/"))
            files[name] = text_of(entry.path());
    }
    return files;
}

bool contains(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

/// Of a command line that is carried out here: exit code and text of its error.
std::pair<int, std::string> error_of(const std::string& arguments)
{
    CLI::App app;
    const auto chosen = declare_commands(app);
    try {
        app.parse(arguments);
        chosen()();
    } catch (const CLI::ParseError& error) {
        return {64, error.what()};
    } catch (const Error& error) {
        return {static_cast<int>(error.kind()), error.what()};
    }
    return {0, ""};
}

class Render : public Program {
protected:
    void SetUp() override
    {
        Program::SetUp();
        write("flow.json", flow);
        ASSERT_EQ(run("run -q flow.json").exit_code, 0);
        results = folder / "out/flow";
    }
    std::string picture(const std::string& name) { return text_of(folder / name); }

    fs::path results;
};

}

TEST_F(Render, GivesTheBytesOfTheSnapshotsOfTheRun)
{
    ASSERT_EQ(run("render out/flow --strain 0.2 --size 240x180 --out a.png").out, "a.png\n");
    EXPECT_EQ(picture("a.png"), text_of(results / "snapshot.png"));
    const Said cut =
        run("render out/flow --colour-by contact_number --view front --clip z=3 "
            "--zoom 1.5 --size 240x180 --out b.png");
    ASSERT_EQ(cut.exit_code, 0) << cut.err;
    EXPECT_EQ(picture("b.png"), text_of(results / "cut.png"));
    EXPECT_NE(picture("a.png"), picture("b.png"));
    // where a plane leaves nothing there is no picture, and the summary says so
    EXPECT_FALSE(fs::exists(results / "nothing.png"));
    EXPECT_TRUE(contains(text_of(results / "summary.json"), "clip plane hides all particles"));
}

TEST_F(Render, ChangesNothingOfTheRunAndWaitsForNoLock)
{
    const auto before = content(results);
    const int lock = open(results.c_str(), O_RDONLY | O_DIRECTORY);
    ASSERT_EQ(flock(lock, LOCK_EX | LOCK_NB), 0);  // a run goes on
    const Said said = run("render out/flow --size 64x64");
    EXPECT_EQ(said.exit_code, 0) << said.err;
    EXPECT_EQ(said.out, "out/flow/render/shear_strain_0.3.png\n");
    EXPECT_EQ(said.err, "");
    EXPECT_EQ(run("render out/flow --size 64x64 --all").exit_code, 0);
    close(lock);
    EXPECT_EQ(content(results), before);
    EXPECT_EQ(run("run -q flow.json").exit_code, 0);  // and the run still takes its folder
}

TEST_F(Render, FilmsHaveOneScaleOfColours)
{
    const io::StoredRun stored = io::read_run(results / "shear/run.h5");
    ASSERT_EQ(stored.frames.size(), 4u);
    const double largest = *ParticlePicture{}.common_view(stored.frames).colour_maximum;
    ASSERT_EQ(run("render out/flow --all --size 160x120 --out film").out,
              "film/00000.png\nfilm/00001.png\nfilm/00002.png\nfilm/00003.png\n");
    char maximum[40];
    std::snprintf(maximum, sizeof maximum, "%.17g", largest);
    ASSERT_EQ(run("render out/flow --frames 0:3 --size 160x120 --out two --colour-maximum " +
                  std::string(maximum))
                  .out,
              "two/00000.png\ntwo/00001.png\ntwo/00002.png\ntwo/00003.png\n");
    EXPECT_EQ(picture("two/00001.png"), picture("film/00001.png"));
    EXPECT_EQ(picture("two/00003.png"), picture("film/00003.png"));
    EXPECT_NE(picture("film/00001.png"), picture("film/00003.png"));
}

TEST_F(Render, DrawsWhatARunningOrKilledStepHasStoredSoFar)
{
    ASSERT_EQ(run("render out/flow --strain 0.1 --size 160x120 --out finished.png").exit_code, 0);
    const io::StoredRun stored = io::read_run(results / "shear/run.h5");
    fs::remove(results / "shear/run.h5");
    const fs::path path = results / "shear/run.journal";
    {
        io::RunJournal journal(path);
        for (const Frame& frame : stored.frames) {
            journal.append(frame.sample, true);
            journal.append(frame);
        }
        journal.finish();
    }
    fs::resize_file(path, fs::file_size(path) - 100);  // the last frame is not there yet
    const Said said = run("render out/flow --strain 0.1 --size 160x120 --out going_on.png");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    EXPECT_EQ(picture("going_on.png"), picture("finished.png"));
    EXPECT_EQ(run("render out/flow --size 64x64").out, "out/flow/render/shear_strain_0.2.png\n");

    fs::resize_file(path, 100);
    const Said none = run("render out/flow");
    EXPECT_EQ(none.exit_code, 65);
    EXPECT_TRUE(contains(none.err, "run.journal: has no frames yet")) << none.err;
    fs::remove(path);  // then the frame at the end of equilibrate is the last one
    EXPECT_EQ(run("render out/flow --size 64x64").out,
              "out/flow/render/equilibrate_strain_0.1.png\n");
    fs::remove(results / "equilibrate/run.h5");
    EXPECT_EQ(run("render out/flow").exit_code, 65);
}

TEST_F(Render, RefusesWhatIsWrongAndSaysWhatIsAllowed)
{
    fs::create_directories(folder / "full");
    write("full/file", "");
    const fs::path here = fs::current_path();
    fs::current_path(folder);
    struct Case {
        std::string arguments;
        int code;
        std::string phrase;
    };
    for (const Case& wrong : std::vector<Case>{
             {"", 64, "DIR"},
             {"nowhere", 66, "nowhere: cannot be read: No such file or directory"},
             {"full", 65, "full: is not the folder of a run"},
             {"out/flow --of pack", 64,
              "--of: must be a step with stored frames: equilibrate, shear, got \"pack\""},
             {"out/flow --strain 0.5", 64, "--strain: must be between 0 and 0.3"},
             {"out/flow --strain x", 64, "--strain"},
             {"out/flow --strain 0.1 --all", 64, "only one of --strain, --frames and --all"},
             {"out/flow --frames 3", 64, "--frames: must be A:B or A:B:STEP"},
             {"out/flow --frames 0:3:0", 64, "--frames: must be A:B"},
             {"out/flow --frames 0:x", 64, "--frames: must be A:B"},
             {"out/flow --frames 0:99999999999999999999", 64, "--frames: must be A:B"},
             {"out/flow --frames 0:4", 64, "--frames: must lie within 0:3"},
             {"out/flow --frames 2:1", 64, "--frames: must lie within 0:3"},
             {"out/flow --colour-by speed", 64, "--colour-by: must be one of nonaffine_speed"},
             {"out/flow --colour-map jet", 64, "--colour-map: must be one of inferno"},
             {"out/flow --colour-maximum 0", 64, "--colour-maximum: must be > 0"},
             {"out/flow --colour-maximum nan", 64, "--colour-maximum"},
             {"out/flow --view back", 64, "--view: must be one of oblique, front, top, side, iso"},
             {"out/flow --elevation 91", 64, "--elevation: must be >= -90 and <= 90"},
             {"out/flow --zoom 0", 64, "--zoom: must be >= 0.1"},
             {"out/flow --zoom big", 64, "--zoom: must be a number"},
             {"out/flow --clip z", 64, "--clip: must be x, y or z = a number"},
             {"out/flow --clip w=3", 64, "--clip: must be x, y or z = a number"},
             {"out/flow --clip z=3:beside", 64, "--clip: must be x, y or z = a number"},
             {"out/flow --clip z=-100", 64,
              "--clip: hides all particles at strain 0.3, the box has z from 0 to"},
             {"out/flow --size 10x10", 64, "--size: must be WIDTHxHEIGHT"},
             {"out/flow --size 640", 64, "--size: must be WIDTHxHEIGHT"},
             {"out/flow --out a.jpg", 64, "--out: must be a folder or a file that ends with .png"},
             {"out/flow --all --out a.png", 64, "--out: must be a folder"},
             {"out/flow --all --out full", 73, "full: is not empty"},
             {"out/flow --out out/flow/snapshot.png", 64, "where only out/flow/render/ is free"},
             {"out/flow --out out/flow/", 64, "where only out/flow/render/ is free"},
             {"out/flow --all --out out/../out/flow/shear", 73, "is not empty"},
             {"out/flow --all --out out/flow/shear/film", 64,
              "where only out/flow/render/ is free"},
             {"out/flow --out /proc/nothing/a.png", 73, "/proc/nothing"}}) {
        const auto [code, text] = error_of("render " + wrong.arguments);
        EXPECT_EQ(code, wrong.code) << wrong.arguments << "\n" << text;
        EXPECT_TRUE(contains(text, wrong.phrase)) << wrong.arguments << "\n" << text;
    }
    fs::current_path(here);
    // a damaged file is refused, not drawn
    fs::resize_file(results / "shear/run.h5", fs::file_size(results / "shear/run.h5") / 2);
    const Said damaged = run("render out/flow");
    EXPECT_EQ(damaged.exit_code, 65);
    EXPECT_TRUE(contains(damaged.err, "run.h5")) << damaged.err;
    EXPECT_FALSE(fs::exists(results / "render"));
}

TEST_F(Render, LinksDoNotLeadToResults)
{
    fs::create_directory_symlink(results, folder / "link");
    const Said said = run("render out/flow --size 64x64 --out link/cut.png");
    EXPECT_EQ(said.exit_code, 64) << said.err;
    const std::string before = text_of(results / "cut.png");
    fs::create_symlink(results / "cut.png", folder / "cut.png");
    run("render out/flow --size 64x64 --out cut.png");
    EXPECT_EQ(text_of(results / "cut.png"), before);
}

TEST(ClipPlanes, AreReadAsTheyAreWritten)
{
    const auto plane = clip_plane("y = -2.5e0:below");
    ASSERT_TRUE(plane);
    EXPECT_EQ(plane->axis, 1);
    EXPECT_EQ(plane->value, -2.5);
    EXPECT_FALSE(plane->hides_above);
    EXPECT_TRUE(clip_plane("x=3")->hides_above);
    EXPECT_TRUE(clip_plane("x=3:above")->hides_above);
    for (const char* wrong : {"", "x", "x=", "=3", "q=3", "x=3:", "x=3:up", "x=3x", "x=inf",
                              "x=nan", "x=0x10", "x=3:above:below", "xx=3", "x=1e999"})
        EXPECT_FALSE(clip_plane(wrong)) << wrong;
}

}
