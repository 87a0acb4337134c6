// A run goes on from a file or from a stored frame exactly where that was.
#include "tests/workflows/program.h"

#include "io/series_csv.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::json;

constexpr const char* first = R"({
  "suspension": {"particles": 40, "volume_fraction": 0.5, "seed": 3},
  "steps": [{"step": "pack"},
            {"step": "shear", "stress": 2, "strain": 0.6, "frame_interval": 0.2}]})";

class StoredState : public Program {
protected:
    void SetUp() override
    {
        Program::SetUp();
        write("first.json", first);
        ASSERT_EQ(run("run -q first.json").exit_code, 0);
    }
    std::vector<Sample> series(const std::string& file)
    {
        return io::read_series(folder / "out" / file / "series.csv");
    }
    /// The first sample of a run that begins with this step.
    Sample first_sample_after(const std::string& step)
    {
        write("second.json", R"({"suspension": {}, "steps": [)" + step +
                                 R"(, {"step": "shear", "stress": 2, "strain": 0.02}]})");
        const Said said = run("run -q --force second.json");
        EXPECT_EQ(said.exit_code, 0) << said.err;
        return series("second/shear").front();
    }
    Json step_results(const std::string& out, const std::string& step)
    {
        return Json::parse(text_of(folder / "out" / out / "summary.json"))["steps"][step];
    }
};

/// All but strain and time, to the accuracy of the solver (1e-8 of the velocities).
void expect_same_instant(const Sample& found, const Sample& before)
{
    EXPECT_EQ(found.strain, 0);
    EXPECT_EQ(found.time, 0);
    for (const SampleField& field : sample_fields()) {
        if (field.name == "strain" || field.name == "time") continue;
        const double expected = before.*field.value;
        EXPECT_NEAR(found.*field.value, expected, 1e-6 * (1 + std::abs(expected))) << field.name;
    }
}

}

TEST_F(StoredState, ContinuesFromTheLastStateOfARun)
{
    const Sample last = series("first/shear").back();
    ASSERT_GT(last.contact_number, 0);  // springs are a part of the state
    for (const char* file : {"state.json", "run.h5"})
        expect_same_instant(first_sample_after(R"({"step": "stored_state",
            "file": "out/first/shear/)" + std::string(file) +
                                               "\"}"),
                            last);
}

TEST_F(StoredState, ContinuesFromAFrameInTheMiddle)
{
    const std::vector<Sample> before = series("first/shear");
    const Sample found = first_sample_after(R"({"step": "stored_state",
        "file": "out/first/shear/run.h5", "strain": 0.4})");
    EXPECT_NEAR(before[40].strain, 0.4, 1e-12);
    expect_same_instant(found, before[40]);
    EXPECT_NEAR(step_results("second", "stored_state")["strain"].get<double>(), 0.4, 1e-12);
}

TEST_F(StoredState, ContinuesFromAFrameOfARunOfTheSameWorkflow)
{
    write("branches.json", R"({"suspension": {"particles": 40, "volume_fraction": 0.5, "seed": 3},
        "steps": [{"step": "pack"},
          {"step": "shear", "stress": 2, "strain": 0.6, "frame_interval": 0.2},
          {"step": "stored_state", "of": "shear", "strain": 0.2},
          {"step": "shear", "name": "branch", "stress": 2, "strain": 0.4}]})");
    const Said said = run("run -q branches.json");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    const std::vector<Sample> before = series("branches/shear"), after = series("branches/branch");
    expect_same_instant(after.front(), before[20]);
    // the step sizes begin anew, so that the end agrees to the error of the steps only
    EXPECT_NEAR(after.back().shear_rate, before.back().shear_rate, 0.01 * before.back().shear_rate);
}

TEST_F(StoredState, SaysWhichPartsOfTheModelAreOthers)
{
    write("second.json", R"({"suspension": {"model": {"debye_length": 0.05}}, "steps": [
        {"step": "stored_state", "file": "out/first/shear/run.h5"}]})");
    ASSERT_EQ(run("run -q second.json").exit_code, 0);
    EXPECT_EQ(step_results("second", "stored_state")["model_changed"],
              Json::parse(R"({"debye_length": [0.02, 0.05]})"));
}

TEST_F(StoredState, IsTakenAgainWhenItsFileIsAnother)
{
    write("second.json", R"({"suspension": {}, "steps": [
        {"step": "stored_state", "file": "state.json"},
        {"step": "shear", "stress": 2, "strain": 0.02}]})");
    namespace fs = std::filesystem;
    fs::copy_file(folder / "out/first/shear/state.json", folder / "state.json");
    ASSERT_EQ(run("run -q second.json").exit_code, 0);
    const Sample once = series("second/shear").front();
    fs::copy_file(folder / "out/first/pack/state.json", folder / "state.json",
                  fs::copy_options::overwrite_existing);
    ASSERT_EQ(run("run -q second.json").exit_code, 0);
    EXPECT_GT(once.contact_number, 0);
    EXPECT_EQ(series("second/shear").front().contact_number, 0);  // packings have none
}

TEST_F(StoredState, ItsResolvedWorkflowIsTheSameWorkflow)
{
    first_sample_after(R"({"step": "stored_state", "file": "out/first/shear/run.h5"})");
    const Json manifest = Json::parse(text_of(folder / "out/second/manifest.json"));
    write("again.json", manifest["workflow"].dump());
    const Said said = run("run -q again.json");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    EXPECT_EQ(text_of(folder / "out/second/shear/series.csv"),
              text_of(folder / "out/again/shear/series.csv"));
}

TEST_F(StoredState, WrongOnesAreRefusedBeforeAnythingIsComputed)
{
    write("text.h5", "\x89HDF\r\n\x1a\n and no more");
    const std::array<std::array<const char*, 3>, 10> wrong{{
        {"{}", R"("file": "none.json")", "/steps/0/file: must be a file, there is none"},
        {"{}", R"("file": "first.json")", "/steps/0/file: cannot be used: "},
        {"{}", R"("file": "text.h5")", "/steps/0/file: cannot be used: "},
        {"{}", R"("of": "shear")", "/steps/0: needs a run"},
        {"{}", "\"strain\": 1", "/steps/0: needs a run"},
        {"{}", R"("file": "out/first/shear/run.h5", "of": "shear")", "/steps/0/of: file already"},
        {"{}", R"("file": "out/first/shear/run.h5", "strain": 0.7)",
         "/steps/0/strain: must be <= 0.6"},
        {"{}", R"("file": "out/first/shear/state.json", "strain": 0.1)",
         "/steps/0/strain: is for a run.h5"},
        {R"({"particles": 50})", R"("file": "out/first/shear/run.h5")",
         "has 40 particles, the suspension says 50"},
        {R"({"volume_fraction": 0.4})", R"("file": "out/first/shear/state.json")",
         "has the volume fraction 0.5, the suspension says 0.4"},
    }};
    for (const auto& [suspension, step, message] : wrong) {
        write("wrong.json", std::string("{\"suspension\": ") + suspension +
                                R"(, "steps": [{"step": "stored_state", )" + step + "}]}");
        const Said said = run("run -q wrong.json");
        EXPECT_EQ(said.exit_code, 65) << step;
        EXPECT_NE(said.err.find(message), std::string::npos) << step << "\n" << said.err;
        EXPECT_FALSE(std::filesystem::exists(folder / "out/wrong"));
    }
}

}
