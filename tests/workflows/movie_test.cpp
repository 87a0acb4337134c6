// Films of runs: which frames they show, and that nothing else is left.
#include "tests/workflows/program.h"

#include "render/image.h"
#include "tests/support/film_reader.h"

#include <array>
#include <nlohmann/json.hpp>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::json;

class Movie : public Program {
protected:
    /// Of a run of strain 0.1 with six frames.
    Json film(const std::string& parameters)
    {
        write("film.json",
              R"({"suspension": {"particles": 30, "volume_fraction": 0.4, "size_ratio": 1,
            "seed": 3}, "steps": [{"step": "pack"},
            {"step": "shear", "stress": 2, "strain": 0.1, "frame_interval": 0.02},
            {"step": "movie", "width": 200, "height": 111)" +
                  parameters + "}]}");
        const Said said = run("run -q film.json");
        EXPECT_EQ(said.exit_code, 0) << said.err;
        return Json::parse(text_of(folder / "out/film/summary.json"))["steps"]["movie"];
    }
    test::Film played() { return test::read_film(text_of(folder / "out/film/movie.ogv")); }
    std::size_t pictures()
    {
        std::size_t count = 0;
        for (const auto& entry : std::filesystem::directory_iterator(folder / "out/film/movie"))
            count += entry.path().extension() == ".png";
        return count;
    }
};

}

TEST_F(Movie, ShowsEveryStoredFrameOfTheRun)
{
    const Json results = film("");
    EXPECT_EQ(results["frames"], 6);
    const test::Film shown = played();
    EXPECT_EQ(shown.frames.size(), 6u);
    EXPECT_DOUBLE_EQ(shown.frames_per_second, 12);
    EXPECT_EQ(shown.width, 200);
    EXPECT_EQ(shown.height, 112);
    EXPECT_EQ(pictures(), 6u);
    EXPECT_EQ(render::read_png(folder / "out/film/movie.png").height, 111);
    EXPECT_FALSE(std::filesystem::exists(folder / "out/film/movie.ogv.tmp"));
    const std::string bytes = text_of(folder / "out/film/movie.ogv");
    ASSERT_EQ(run("run -q --force film.json").exit_code, 0);
    EXPECT_EQ(text_of(folder / "out/film/movie.ogv"), bytes);
}

TEST_F(Movie, OfAPartOfTheRunLeavesNoPicturesOfAnEarlierFilm)
{
    film("");
    const Json part = film(R"(, "from_strain": 0.04, "to_strain": 0.08, "frames_per_second": 25)");
    EXPECT_EQ(part["frames"], 3);
    EXPECT_NEAR(part["from_strain"].get<double>(), 0.04, 1e-12);
    EXPECT_NEAR(part["to_strain"].get<double>(), 0.08, 1e-12);
    EXPECT_EQ(played().frames.size(), 3u);
    EXPECT_EQ(pictures(), 3u);
    const Json fewer = film(", \"most_frames\": 2");  // the first one and the last one
    EXPECT_EQ(fewer["frames"], 2);
    EXPECT_EQ(fewer["from_strain"], 0);
    EXPECT_NEAR(fewer["to_strain"].get<double>(), 0.1, 1e-12);
    EXPECT_EQ(pictures(), 2u);
}

TEST_F(Movie, OfOneFrameOrNoneSaysSo)
{
    const Json one = film(R"(, "from_strain": 0.1)");
    EXPECT_EQ(one["outcome"], "one frame only");
    EXPECT_EQ(played().frames.size(), 1u);
    const Json none = film(R"(, "from_strain": 0.045, "to_strain": 0.055)");
    EXPECT_EQ(none["frames"], 0);
    EXPECT_FALSE(std::filesystem::exists(folder / "out/film/movie.ogv"));
}

TEST_F(Movie, OfTheChainsOfContacts)
{
    EXPECT_GT(film(R"(, "colour_by": "normal_force")")["colour_maximum"].get<double>(), 0);
    EXPECT_EQ(played().frames.size(), 6u);
}

TEST_F(Movie, WrongOnesAreRefused)
{
    const std::array<std::array<const char*, 2>, 4> wrong{{
        {"\"to_strain\": 6", "/steps/2/to_strain: must be <= 5, the strain of"},
        {"\"from_strain\": 2, \"to_strain\": 1", "/steps/2/to_strain: must be >= from_strain, 2"},
        {"\"most_frames\": 1", "/steps/2/most_frames: must be"},
        {"\"of\": \"shaer\"", "/steps/2/of: must be"},
    }};
    for (const auto& [given, message] : wrong) {
        write("film.json", std::string(R"({"suspension": {}, "steps": [{"step": "pack"},
            {"step": "shear", "stress": 1}, {"step": "movie", )") +
                               given + "}]}");
        const Said said = run("run -q film.json");
        EXPECT_EQ(said.exit_code, 65);
        EXPECT_NE(said.err.find(message), std::string::npos) << given << "\n" << said.err;
    }
}

}
