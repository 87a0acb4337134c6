// The steps "uniformity" and "energy" through the program: files, numbers, short and jammed runs.
#include "tests/workflows/program.h"

#include "io/run_file.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::json;

class FlowChecks : public Program {
protected:
    Json steps(const std::string& run)
    {
        return Json::parse(text_of(folder / "out" / run / "summary.json"))["steps"];
    }
    /// Rows of a table without its comment and head; empty cells are NaN.
    std::vector<std::vector<double>> table(const std::string& name)
    {
        std::istringstream text(text_of(folder / "out" / name));
        std::vector<std::vector<double>> rows;
        std::string line;
        std::getline(text, line);
        EXPECT_TRUE(line.starts_with("#")) << name;
        std::getline(text, line);
        while (std::getline(text, line)) {
            rows.emplace_back();
            std::istringstream cells(line);
            for (std::string cell; std::getline(cells, cell, ',');)
                rows.back().push_back(cell.empty() ? NAN : std::stod(cell));
        }
        return rows;
    }
};

constexpr const char* flowing = R"({
  "suspension": {"particles": 60, "volume_fraction": 0.45, "seed": 3},
  "steps": [
    {"step": "pack"},
    {"step": "shear", "stress": 2, "strain": 0.6, "frame_interval": 0.05},
    {"step": "uniformity", "bins": 12, "spacing": 0.05, "from_strain": 0, "width": 640, "height": 360},
    {"step": "energy", "width": 640, "height": 360}
  ]
})";

}

TEST_F(FlowChecks, UniformityLeavesTablesPicturesAndAVerdict)
{
    write("flow.json", flowing);
    const Said said = run("run flow.json -q");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    for (const std::string name : {"uniformity", "uniformity_y", "uniformity_z",
                                   "uniformity_space_time_y", "uniformity_space_time_z", "energy"})
        for (const char* type : {".png", ".svg"})
            EXPECT_GT(std::filesystem::file_size(folder / "out/flow" / (name + type)), 1000u)
                << name;
    const Json result = steps("flow")["uniformity"];
    EXPECT_EQ(result["frames"], 13);
    const std::string verdict = result["outcome"];
    EXPECT_TRUE(verdict.starts_with("uniform") || verdict.starts_with("bands") ||
                verdict.starts_with("undecided"))
        << verdict;
    EXPECT_EQ(result["fields"].size(), 8u);  // four across y without the velocity, four across z
    for (const Json& field : result["fields"])
        if (field["independent_frames"].get<int>() >= 4)
            for (const char* test : {"chi2", "two_bands", "moving_bands", "order_parameter"}) {
                const double p = field[test]["p_value"];
                EXPECT_TRUE(p > 0 && p <= 1) << test;
            }

    const auto rows = table("flow/uniformity_y.csv");
    ASSERT_EQ(rows.size(), 12u);
    double velocity = 0, rate = 0, fraction = 0, stress = 0;
    for (const auto& row : rows) {
        ASSERT_EQ(row.size(), 11u);
        velocity += row[1];
        rate += row[3] / 12;
        fraction += row[5] / 12;
        stress += row[7] / 12;
    }
    EXPECT_NEAR(velocity, 0, 1e-9);
    EXPECT_NEAR(rate, 1, 1e-9);
    EXPECT_NEAR(fraction, 1, 1e-9);
    EXPECT_NEAR(stress, 1, 1e-9);
    EXPECT_EQ(table("flow/uniformity_z.csv").at(0).size(), 9u);
}

TEST_F(FlowChecks, EnergyBalancesAtEveryFrame)
{
    write("flow.json", flowing);
    ASSERT_EQ(run("run flow.json -q").exit_code, 0);
    const Json result = steps("flow")["energy"];
    EXPECT_EQ(result["frames"], 13);
    EXPECT_LT(result["largest_residual"].get<double>(), 1e-7);
    EXPECT_EQ(result["outcome"], "power put in is power stored and dissipated");
    const io::StoredRun stored = io::read_run(folder / "out/flow/shear/run.h5");
    const auto rows = table("flow/energy.csv");
    ASSERT_EQ(rows.size(), stored.frames.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Frame& frame = stored.frames[i];
        EXPECT_NEAR(rows[i][0], frame.state.strain, 1e-12);
        const double input =
            frame.sample.shear_stress * frame.sample.shear_rate * frame.state.box.volume();
        EXPECT_NEAR(rows[i][2], input, 1e-6 * std::abs(input));
        const double sum = std::accumulate(rows[i].begin() + 3, rows[i].end() - 1, 0.0);
        EXPECT_NEAR(sum, input, 1e-6 * std::abs(input));
    }
    double shares = 0;
    if (result.contains("shares_of_input")) {
        for (const Json& share : result["shares_of_input"]) shares += share["mean"].get<double>();
        EXPECT_NEAR(shares, 1, 1e-6);
    }
}

TEST_F(FlowChecks, ShortAndJammedRunsAreSaidToBeUndecided)
{
    write("short.json", R"({"suspension": {"particles": 50, "volume_fraction": 0.4},
        "steps": [{"step": "pack"},
                  {"step": "shear", "stress": 2, "strain": 0.1, "frame_interval": 0.1},
                  {"step": "uniformity", "from_strain": 0, "spacing": 0.1, "width": 640, "height": 360},
                  {"step": "uniformity", "name": "late", "from_strain": 0.1}]})");
    Said said = run("run short.json -q");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    EXPECT_EQ(steps("short")["uniformity"]["outcome"],
              "undecided: too few frames, 2 independent of 2");
    EXPECT_TRUE(steps("short")["late"]["outcome"].get<std::string>().starts_with("undecided"));
    write("jams.json", R"({"suspension": {"particles": 50, "volume_fraction": 0.61},
        "steps": [{"step": "pack"},
                  {"step": "shear", "stress": 20, "strain": 1, "frame_interval": 0.02},
                  {"step": "uniformity"}, {"step": "energy"}]})");
    said = run("run jams.json -q");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    ASSERT_EQ(steps("jams")["shear"]["outcome"], "jammed");
    EXPECT_EQ(steps("jams")["uniformity"]["outcome"], "undecided: the suspension is jammed");
    EXPECT_LT(steps("jams")["energy"]["largest_residual"].get<double>(), 1e-6);
}

TEST_F(FlowChecks, WrongParametersAreRefusedBeforeAnythingIsComputed)
{
    write("wrong.json", R"({"suspension": {"particles": 50, "volume_fraction": 0.4},
        "steps": [{"step": "pack"},
                  {"step": "shear", "stress": 2, "strain": 0.1, "frame_interval": 0.1},
                  {"step": "uniformity", "from_strain": 3}]})");
    const Said late = run("run wrong.json");
    EXPECT_EQ(late.exit_code, 65);
    EXPECT_NE(late.err.find("wrong.json:4:57: /steps/2/from_strain: must be <= 0.1"),
              std::string::npos)
        << late.err;
    write("none.json", R"({"suspension": {"particles": 50, "volume_fraction": 0.4},
        "steps": [{"step": "pack"}, {"step": "energy"}]})");
    EXPECT_EQ(run("run none.json").exit_code, 65);
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

}
