// sigmaflow status of runs in every state; it changes nothing.
#include "tests/workflows/program.h"

#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>

namespace sigmaflow::workflows {

namespace {

class Status : public Program {
protected:
    void write_flow(const std::string& strain, const std::string& more = "")
    {
        write("w.json", R"({"suspension": {"particles": 30, "volume_fraction": 0.45},
            "steps": [{"step": "pack"}, {"step": "shear", "stress": 2, "strain": )" +
                            strain + "}" + more + "]}");
    }

    nlohmann::json status()
    {
        const Said said = run("status out/w --json");
        EXPECT_EQ(said.exit_code, 0) << said.err;
        return nlohmann::json::parse(said.out);
    }

    /// Starts the program in the background; returns its process.
    pid_t start()
    {
        const pid_t child = fork();
        if (child == 0) {
            std::filesystem::current_path(folder);
            execl(SIGMAFLOW_PROGRAM, SIGMAFLOW_PROGRAM, "run", "w.json", "-q",
                  "--checkpoint-interval", "0", nullptr);
            _exit(1);
        }
        // until something of the shearing step is stored
        for (int k = 0; k < 2000; ++k) {
            if (std::filesystem::exists(folder / "out/w/.sigmaflow/checkpoint.1")) break;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        return child;
    }
};

}

TEST_F(Status, OfACompleteRunHasAllStepsAndAsksForTheReport)
{
    write_flow("0.1");
    ASSERT_EQ(run("run w.json -q").exit_code, 0);
    const auto found = status();
    EXPECT_EQ(found["state"], "complete");
    ASSERT_EQ(found["steps"].size(), 2u);
    EXPECT_EQ(found["steps"][1]["state"], "done");
    EXPECT_NE(found["steps"][1]["outcome"].get<std::string>().find("flowing"), std::string::npos);
    EXPECT_EQ(found["next"], "sigmaflow report out/w");
    EXPECT_TRUE(found["checkpoint"].is_null());
}

TEST_F(Status, OfARunThatGoesOnAndOfOneThatWasKilled)
{
    write_flow("1000", R"(, {"step": "plot"})");
    const pid_t child = start();
    const auto running = status();
    EXPECT_EQ(running["state"], "running");
    EXPECT_EQ(running["owner"].get<std::string>().find("process " + std::to_string(child) + " on "),
              0u);
    EXPECT_EQ(running["steps"][0]["state"], "done");
    EXPECT_EQ(running["steps"][1]["state"], "running");
    EXPECT_EQ(running["steps"][2]["state"], "to do");
    EXPECT_EQ(running["next"], "sigmaflow status out/w");
    EXPECT_EQ(run("verify out/w").exit_code, 75);

    kill(child, SIGKILL);
    int ended = 0;
    waitpid(child, &ended, 0);
    const auto killed = status();
    EXPECT_EQ(killed["state"], "killed");
    EXPECT_EQ(killed["steps"][1]["state"], "killed");
    EXPECT_EQ(killed["checkpoint"]["step"], "shear");
    EXPECT_GT(killed["checkpoint"]["strain"], 0);
    EXPECT_NEAR(killed["checkpoint"]["share"].get<double>(),
                killed["checkpoint"]["strain"].get<double>() / 1000, 1e-12);
    EXPECT_EQ(killed["next"], "sigmaflow run " + (folder / "w.json").string() + " --out out/w");
    EXPECT_EQ(run("verify out/w").exit_code, 0);
}

TEST_F(Status, OfAnInterruptedAndOfAFailedRunTellsWhy)
{
    write_flow("1000");
    ASSERT_EQ(run("run w.json -q --max-walltime 1s").exit_code, 3);
    auto found = status();
    EXPECT_EQ(found["state"], "interrupted");
    EXPECT_NE(found["error"].get<std::string>().find("wall time"), std::string::npos) << found;
    std::string manifest = text_of(folder / "out/w/manifest.json");
    manifest.replace(manifest.find("\"interrupted\""), 13, "\"failed\"");
    write("out/w/manifest.json", manifest);
    found = status();
    EXPECT_EQ(found["state"], "failed");
    EXPECT_EQ(found["steps"][1]["state"], "failed");
}

TEST_F(Status, OfARunKilledBeforeItsFirstStepAndOfOtherFolders)
{
    std::filesystem::create_directories(folder / "out/w/.sigmaflow");
    EXPECT_EQ(status()["state"], "killed");
    EXPECT_EQ(run("status nowhere").exit_code, 66);
    std::filesystem::create_directories(folder / "mine");
    EXPECT_EQ(run("status mine").exit_code, 65);
    EXPECT_TRUE(std::filesystem::is_empty(folder / "mine"));
}

}
