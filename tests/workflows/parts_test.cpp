// A step made of parts: side by side or one after the other, killed or not, its files are the same.
#include "tests/workflows/program.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace sigmaflow::workflows {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* ensemble = R"({
  "suspension": {"particles": 60, "volume_fraction": 0.56, "seed": 3},
  "steps": [
    {"step": "step_stress", "starts": 6, "strain_before": 0.3, "strain_after": 0.05,
     "series_interval": 0.001, "width": 320, "height": 180}
  ]
})";

class Ensemble : public Program {
protected:
    void SetUp() override
    {
        Program::SetUp();
        write("ensemble.json", ensemble);
    }
    std::string result(const std::string& out, const std::string& name)
    {
        const std::string text = text_of(folder / out / name);
        EXPECT_FALSE(text.empty()) << name;
        return text;
    }
    /// The exit code of a run that gets a signal when two parts are stored.
    int stopped_after_two_parts(const std::string& out, const std::string& signal)
    {
        const std::string command =
            "cd '" + folder.string() + "'; '" + SIGMAFLOW_PROGRAM +
            "' run -q ensemble.json --out " + out + " 2>/dev/null & pid=$!; while ! [ -e '" +
            (parts(out) / "1").string() + "' ] && kill -0 $pid; do sleep 0.02; done; kill -" +
            signal + " $pid; wait $pid";
        const int status = std::system((command).c_str());
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    fs::path parts(const std::string& out) { return folder / out / ".sigmaflow/step_stress.parts"; }
};

}

TEST_F(Ensemble, ThreadsChangeNothing)
{
    ASSERT_EQ(run("run -q ensemble.json --out one").exit_code, 0);
    ASSERT_EQ(run("run -q ensemble.json --out two --threads 3").exit_code, 0);
    for (const char* name : {"step_stress.csv", "step_stress_starts.csv", "summary.json",
                             "step_stress_shear_rate.svg"})
        EXPECT_EQ(result("one", name), result("two", name)) << name;
    EXPECT_FALSE(fs::exists(parts("one")));
}

TEST_F(Ensemble, GoesOnWithTheMissingPartsAfterAKill)
{
    ASSERT_EQ(run("run -q ensemble.json --out whole").exit_code, 0);
    EXPECT_EQ(stopped_after_two_parts("killed", "KILL"), 128 + 9);
    const Said said = run("run ensemble.json --out killed");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    EXPECT_EQ(result("killed", "step_stress.csv"), result("whole", "step_stress.csv"));
    EXPECT_EQ(result("killed", "summary.json"), result("whole", "summary.json"));
    EXPECT_FALSE(fs::exists(parts("killed")));
}

TEST_F(Ensemble, StopsWhenAskedAndGoesOn)
{
    ASSERT_EQ(run("run -q ensemble.json --out whole").exit_code, 0);
    EXPECT_EQ(stopped_after_two_parts("stopped", "TERM"), 3);
    EXPECT_TRUE(fs::exists(parts("stopped") / "0"));
    ASSERT_EQ(run("run -q ensemble.json --out stopped").exit_code, 0);
    EXPECT_EQ(result("stopped", "step_stress.csv"), result("whole", "step_stress.csv"));
}

TEST_F(Ensemble, PartsOfOtherParametersAndDamagedPartsAreComputedAgain)
{
    ASSERT_EQ(run("run -q ensemble.json --out whole").exit_code, 0);
    fs::create_directories(parts("again"));
    write("again/.sigmaflow/step_stress.parts/0", "no part");
    ASSERT_EQ(run("run -q ensemble.json --out again").exit_code, 0);
    EXPECT_EQ(result("again", "step_stress.csv"), result("whole", "step_stress.csv"));
}

// With springs that follow the stress at once, contacts carry their share at once; with springs
// that are kept, they have to be charged first, but the flow is the same in the end.
TEST_F(Ensemble, SpringsThatAreKeptAreChargedBeforeTheyCarryTheStress)
{
    std::string both = ensemble;
    both.replace(both.find("\"starts\""), 0,
                 "\"sweep\": {\"stiffness\": [\"rescaled\", \"kept\"]}, ");
    write("both.json", both);
    ASSERT_EQ(run("run -q both.json").exit_code, 0);
    const Json steps = Json::parse(result("out/both", "summary.json"))["steps"];
    const Json &rescaled = steps["step_stress_rescaled"], &kept = steps["step_stress_kept"];
    EXPECT_EQ(rescaled["rate_before"], kept["rate_before"]);
    EXPECT_GT(kept["rate_just_after"]["mean"],
              1.2 * rescaled["rate_just_after"]["mean"].get<double>());
    EXPECT_NEAR(kept["rate_at_the_end"]["mean"], rescaled["rate_at_the_end"]["mean"],
                0.3 * rescaled["rate_at_the_end"]["mean"].get<double>());
    // what answers at once is the liquid: solvent, spheres, lubrication films
    EXPECT_GT(kept["viscosity_of_the_jump"]["mean"], 1 + 2.5 * 0.56);
    EXPECT_LT(kept["viscosity_of_the_jump"]["mean"],
              0.6 * kept["viscosity_before"]["mean"].get<double>());
}

}
