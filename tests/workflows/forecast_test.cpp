#include "workflows/forecast.h"

#include "engine/error.h"
#include "workflows/workflow.h"

#include <gtest/gtest.h>

namespace sigmaflow::workflows {

namespace {

std::string flow(int particles, const std::string& volume_fraction, const std::string& more = "")
{
    return R"({"suspension": {"particles": )" + std::to_string(particles) +
           R"(, "volume_fraction": )" + volume_fraction +
           R"(}, "steps": [{"step": "pack"}, {"step": "shear", "stress": 1, "strain": 1,
           "frame_interval": 0.1})" +
           more + "]}";
}

Forecast forecast_of(const std::string& text)
{
    return forecast(parse_workflow(text, "w.json"));
}

/// What check_room says of a workflow for 4500 particles.
std::string complaint(const Room& room, ErrorKind kind)
{
    const std::string text = flow(4500, "0.55");
    const io::JsonDocument document = io::JsonDocument::parse(text, "w.json");
    try {
        check_room(forecast(parse_workflow(text, "w.json")), room, document.root(), "out");
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), kind);
        return error.what();
    }
    return "";
}

}

// Peaks of the resident set of `sigmaflow run` for such workflows [MB], /usr/bin/time -f %M.
TEST(Forecast, MemoryIsThatOfRuns)
{
    struct Measured {
        int particles;
        const char* volume_fraction;
        double megabytes;
    };
    for (const Measured& m :
         {Measured{500, "0.45", 57}, Measured{500, "0.55", 65}, Measured{2000, "0.45", 174},
          Measured{2000, "0.55", 222}, Measured{4500, "0.55", 433}, Measured{4500, "0.58", 462},
          Measured{10000, "0.45", 808}, Measured{10000, "0.55", 1212},
          Measured{10000, "0.58", 1323}, Measured{15000, "0.3", 592},
          Measured{15000, "0.55", 2026}})
        EXPECT_NEAR(forecast_of(flow(m.particles, m.volume_fraction)).memory / 1e6, m.megabytes,
                    0.25 * m.megabytes)
            << m.particles << " " << m.volume_fraction;
}

TEST(Forecast, PicturesAndStoredFramesNeedMemory)
{
    const double alone = forecast_of(flow(500, "0.55")).memory;
    const Forecast drawn =
        forecast_of(flow(500, "0.55", R"(, {"step": "snapshot", "width": 3840, "height": 3840})"));
    EXPECT_NEAR(drawn.memory / 1e6, 2626, 0.25 * 2626);  // measured
    EXPECT_EQ(drawn.step, "snapshot");
    const Forecast plotted =
        forecast_of(flow(500, "0.55", R"(, {"step": "plot", "width": 3840, "height": 3840})"));
    EXPECT_GT(plotted.memory, alone);
    EXPECT_LT(plotted.memory, drawn.memory);
    const std::string many = R"({"suspension": {"particles": 2000}, "steps": [{"step": "pack"},
        {"step": "shear", "stress": 1, "strain": 100, "frame_interval": 0.01},
        {"step": "velocity_profile"}]})";
    EXPECT_EQ(forecast_of(many).step, "velocity_profile");
    EXPECT_GT(forecast_of(many).memory, 1e4 * 2000 * 500.);
}

// Measured: 2000 particles in the thickened state, 201 frames, 162 MB HDF5, 136 MB VTK and the
// journal of 142 MB until the end.
TEST(Forecast, DiskIsThatOfRuns)
{
    const std::string text = R"({"suspension": {"particles": 2000, "volume_fraction": 0.55},
        "steps": [{"step": "pack"}, {"step": "shear", "stress": 20, "strain": 1,
                   "frame_interval": 0.005, "series_interval": 0.005}]})";
    EXPECT_NEAR(forecast_of(text).disk / 1e6, 440, 0.25 * 440);
}

TEST(Forecast, RefusesWhatTheMachineLacks)
{
    EXPECT_EQ(complaint({.memory = 1e9, .memory_limit = "left", .disk = 1e9}, ErrorKind::input),
              "");
    EXPECT_EQ(complaint({.memory = {}, .memory_limit = "", .disk = {}}, ErrorKind::input), "");
    EXPECT_EQ(
        complaint({.memory = 1e8, .memory_limit = "left here", .disk = 1e9}, ErrorKind::input),
        "w.json:1:17: /suspension/particles: the step \"shear\" needs about 495 MB of memory, "
        "more than the 100 MB left here");
    EXPECT_EQ(complaint({.memory = 1e9, .memory_limit = "left", .disk = 2e6}, ErrorKind::no_space),
              "out: the run needs about 96 MB, the disk has only 2.0 MB left");
}

TEST(Forecast, KnowsTheRoomOfThisMachine)
{
    const Room room = room_here(".");
    ASSERT_TRUE(room.memory && room.disk);
    EXPECT_GT(*room.memory, 1e6);
    EXPECT_FALSE(room.memory_limit.empty());
    EXPECT_FALSE(room_here("no such folder").disk);
}

}
