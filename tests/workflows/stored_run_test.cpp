// Runs of other workflows are analysed as if they were made here.
#include "tests/workflows/program.h"

#include "io/run_file.h"

#include <nlohmann/json.hpp>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::json;

constexpr const char* first = R"({
  "suspension": {"particles": 30, "volume_fraction": 0.4, "size_ratio": 1, "seed": 3},
  "steps": [
    {"step": "pack"},
    {"step": "shear", "stress": 2, "strain": 0.3, "frame_interval": 0.1},
    {"step": "shear", "name": "changed", "stress": 2, "strain": 0.3, "frame_interval": 0.1,
     "model": {"debye_length": 0.05, "friction_static": 0.5, "friction_dynamic": 0.5}},
    {"step": "velocity_profile", "of": "shear", "bins": 5, "spacing": 0.1}
  ]
})";

class StoredRun : public Program {
protected:
    void SetUp() override
    {
        Program::SetUp();
        write("first.json", first);
        ASSERT_EQ(run("run -q first.json").exit_code, 0);
    }
    Json steps(const std::string& out)
    {
        return Json::parse(text_of(folder / out / "summary.json"))["steps"];
    }
};

constexpr const char* second = R"({"steps": [
    {"step": "stored_run", "file": "out/first/shear/run.h5"},
    {"step": "velocity_profile", "bins": 5, "spacing": 0.1},
    {"step": "statistics"}]})";

}

TEST_F(StoredRun, GivesTheNumbersOfTheRunItself)
{
    write("second.json", second);
    const Said said = run("run second.json");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    const Json there = steps("out/first"), here = steps("out/second");
    for (const char* name : {"viscosity", "shear_rate", "contact_number", "effective_samples"}) {
        EXPECT_EQ(here["stored_run"][name], there["shear"][name]) << name;
        EXPECT_EQ(here["statistics"][name], there["shear"][name]) << name;
    }
    EXPECT_EQ(here["velocity_profile"]["slope"], there["velocity_profile"]["slope"]);
    EXPECT_EQ(text_of(folder / "out/second/velocity_profile.csv"),
              text_of(folder / "out/first/velocity_profile.csv"));
}

// Distances end at half the box of the run, not at that of any suspension of the workflow.
TEST_F(StoredRun, BringsItsOwnBox)
{
    for (const char* suspension : {"", "\"suspension\": {\"particles\": 400},"}) {
        write("structure.json", std::string("{") + suspension + R"("steps": [
            {"step": "stored_run", "file": "out/first/shear/run.h5"}, {"step": "structure"}]})");
        const Said said = run("run -q structure.json --force");
        ASSERT_EQ(said.exit_code, 0) << said.err;
        const Vec3 box = io::read_run(folder / "out/first/shear/run.h5").frames[0].state.box.length;
        EXPECT_NEAR(steps("out/structure")["structure"]["largest_distance"], box.minCoeff() / 2,
                    1e-12);
    }
}

TEST_F(StoredRun, IsReadAgainWhenItsFileIsAnother)
{
    write("second.json", second);
    ASSERT_EQ(run("run -q second.json").exit_code, 0);
    EXPECT_NE(run("run second.json").err.find("stored_run: flowing"), std::string::npos);
    std::filesystem::copy_file(folder / "out/first/changed/run.h5",
                               folder / "out/first/shear/run.h5",
                               std::filesystem::copy_options::overwrite_existing);
    const Said said = run("run second.json");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    EXPECT_NE(said.err.find("stored_run: again, checksum"), std::string::npos) << said.err;
    EXPECT_EQ(steps("out/second")["statistics"]["shear_rate"],
              steps("out/first")["changed"]["shear_rate"]);
}

TEST_F(StoredRun, IsRelativeToTheWorkflowAndNeedsNoSuspension)
{
    std::filesystem::create_directory(folder / "deep");
    std::string text = second;
    text.replace(text.find("out/"), 0, "../");
    write("deep/second.json", text);
    EXPECT_EQ(run("validate deep/second.json").exit_code, 0);
    write("pack.json", R"({"steps": [{"step": "stored_run", "file": "out/first/shear/run.h5"},
        {"step": "pack"}]})");
    const Said pack = run("validate pack.json");
    EXPECT_EQ(pack.exit_code, 65);
    EXPECT_NE(pack.err.find("pack.json:2:9: /steps/1: needs a \"suspension\""), std::string::npos)
        << pack.err;
}

TEST_F(StoredRun, ThatIsNoneIsRefusedWithPlaceAndReason)
{
    for (const char* file :
         {"out/none.h5", "out/first", "/dev/zero", "first.json", "out/first/shear/series.csv"}) {
        write("wrong.json",
              std::string(R"({"steps": [{"step": "stored_run", "file": ")") + file + "\"}]}");
        const Said said = run("run wrong.json");
        EXPECT_EQ(said.exit_code, 65) << file;
        EXPECT_NE(said.err.find("wrong.json:1:43: /steps/0/file: "), std::string::npos) << said.err;
        EXPECT_FALSE(std::filesystem::exists(folder / "out/wrong"));
    }
}

TEST_F(StoredRun, KnowsTheModelThatItsStepChanged)
{
    const auto model = [&](const char* step) {
        return io::read_run(folder / "out/first" / step / "run.h5").model;
    };
    EXPECT_EQ(model("shear").debye_length, 0.02);
    EXPECT_EQ(model("changed").debye_length, 0.05);
    EXPECT_EQ(model("changed").friction_static, 0.5);
    EXPECT_EQ(model("changed").lubrication_delta, model("shear").lubrication_delta);
    const Said said = run("evaluate out/first/changed/state.json");
    EXPECT_EQ(said.exit_code, 0) << said.err;
}

TEST_F(StoredRun, ChangesOfTheModelAreCheckedLikeTheModel)
{
    const auto refused = [&](const std::string& model, const std::string& reason) {
        std::string text = first;
        const std::size_t at = text.find("{\"debye");
        text.replace(at, text.find("}}", at) + 1 - at, model);
        write("wrong.json", text);
        const Said said = run("validate wrong.json");
        EXPECT_EQ(said.exit_code, 65);
        EXPECT_NE(said.err.find(reason), std::string::npos) << said.err;
    };
    refused(R"({"debye_lenght": 1})", "/steps/2/model/debye_lenght: unknown key, did you mean");
    refused(R"({"debye_length": -1})", "/steps/2/model/debye_length: must be");
    refused(R"({"friction_dynamic": 2})", "friction_dynamic must be <= friction_static");
    refused(R"({"lubrication_range": 9})", "/steps/2/model: forces of this range need a wider box");
}

}
