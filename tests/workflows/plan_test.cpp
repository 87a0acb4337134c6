// sigmaflow plan: what runs and why, without a trace; the times are of the right size.
#include "tests/workflows/program.h"
#include "workflows/cost.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

namespace sigmaflow::workflows {

namespace {

class PlanOfARun : public Program {
protected:
    void write_flow(const std::string& stress, const std::string& strain = "0.5")
    {
        write("w.json", R"({"suspension": {"particles": 100, "volume_fraction": 0.5},
            "steps": [{"step": "pack"}, {"step": "shear", "stress": )" +
                            stress + R"(, "strain": )" + strain +
                            R"(}, {"step": "plot", "width": 320, "height": 240}]})");
    }

    nlohmann::json plan(const std::string& options = "")
    {
        const Said said = run("plan w.json --json " + options);
        EXPECT_EQ(said.exit_code, 0) << said.err;
        return nlohmann::json::parse(said.out);
    }
};

double shear_seconds(const std::string& suspension, const std::string& step)
{
    const Workflow workflow =
        parse_workflow(R"({"suspension": {)" + suspension +
                           R"(}, "steps": [{"step": "pack"}, {"step": "shear", )" + step + "}]}",
                       "w.json");
    return cost(workflow, 1)[1].seconds;
}

}

TEST_F(PlanOfARun, SaysWhatRunsAndWhyAndLeavesNoTrace)
{
    write_flow("2");
    const auto before = plan();
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
    for (const auto& step : before["steps"]) {
        EXPECT_EQ(step["runs"], true);
        EXPECT_EQ(step["why"], "new");
        EXPECT_GT(step["seconds"], 0);
    }
    EXPECT_EQ(before["fits"], true);
    ASSERT_EQ(run("run w.json -q").exit_code, 0);
    EXPECT_EQ(plan()["seconds"], 0);
    EXPECT_NE(run("plan w.json").out.find("nothing to do"), std::string::npos);

    write_flow("3");
    const auto after = plan();
    EXPECT_EQ(after["steps"][0]["runs"], false);
    EXPECT_EQ(after["steps"][0]["why"], "is finished");
    EXPECT_EQ(after["steps"][1]["why"], "stress was 2.0, is 3.0");
    EXPECT_EQ(after["steps"][2]["why"], "a step before it was changed");
    EXPECT_EQ(plan("--force")["steps"][0]["why"], "--force");
}

TEST_F(PlanOfARun, KnowsAnInterruptedStepAndWhoWrites)
{
    write_flow("2", "1000");
    ASSERT_EQ(run("run w.json -q --max-walltime 1s").exit_code, 3);
    const auto found = plan();
    EXPECT_EQ(found["steps"][1]["why"].get<std::string>().find("goes on from strain "), 0u);
    EXPECT_TRUE(found["writer"].is_null());
    const int other = open((folder / "out/w").c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    ASSERT_EQ(flock(other, LOCK_EX | LOCK_NB), 0);
    EXPECT_FALSE(plan()["writer"].is_null());
    close(other);
    write_flow("3", "1000");
    EXPECT_EQ(run("plan w.json").exit_code, 65);
    std::filesystem::create_directories(folder / "mine");
    write("mine/thesis.txt", "precious");
    EXPECT_EQ(run("plan w.json --out mine").exit_code, 73);
}

TEST_F(PlanOfARun, PredictsASmallRunWithinAFactorOfThree)
{
    write_flow("2", "6");
    const double predicted = plan()["steps"][1]["seconds"];
    // processor time, which other programs disturb least
    rusage before{}, after{};
    getrusage(RUSAGE_CHILDREN, &before);
    ASSERT_EQ(run("run w.json -q").exit_code, 0);
    getrusage(RUSAGE_CHILDREN, &after);
    const auto seconds = [](const rusage& usage) {
        return static_cast<double>(usage.ru_utime.tv_sec) + 1e-6 * usage.ru_utime.tv_usec;
    };
    const double taken = seconds(after) - seconds(before);
    EXPECT_LT(predicted, 3 * taken);
    EXPECT_GT(predicted, taken / 3);
}

// Facts of such flows: no numbers of the model itself.
TEST(Cost, GrowsTowardsJammingWithTheSizeAndForShorterSteps)
{
    const auto of = [](const char* phi, const char* n, const std::string& step) {
        return shear_seconds("\"volume_fraction\": " + std::string(phi) + ", \"particles\": " + n,
                             "\"strain\": 2, " + step);
    };
    const double usual = of("0.5", "500", "\"stress\": 2");
    EXPECT_GT(of("0.57", "500", "\"stress\": 2"), 1.5 * usual);
    EXPECT_GT(of("0.57", "500", "\"stress\": 20"), 1.5 * of("0.57", "500", "\"stress\": 2"));
    EXPECT_GT(of("0.5", "2000", "\"stress\": 2"), 4 * usual);
    EXPECT_NEAR(of("0.5", "500", "\"stress\": 2, \"displacement\": 0.001") / usual, 9, 3);
    EXPECT_GT(of("0.5", "500", "\"stress\": 2, \"scheme\": \"heun\""), 4 * usual);
    const double frictionless =
        of("0.57", "500",
           "\"stress\": 20, \"model\": {\"friction_static\": 0, \"friction_dynamic\": 0}");
    EXPECT_LT(frictionless, of("0.57", "500", "\"stress\": 20"));
    EXPECT_GT(of("0.5", "500", "\"stress\": 2, \"frame_interval\": 0.01"), 2 * usual);
}

TEST(Cost, SaysThatASuspensionBeyondItsJammingFractionMayJam)
{
    const auto jams = [](const char* phi) {
        const Workflow workflow = parse_workflow(
            R"({"suspension": {"volume_fraction": )" + std::string(phi) +
                R"(}, "steps": [{"step": "pack"}, {"step": "shear", "stress": 100}]})",
            "w.json");
        return cost(workflow, 1)[1].jams;
    };
    EXPECT_TRUE(jams("0.62"));
    EXPECT_FALSE(jams("0.55"));
}

}
