// sigmaflow verify: no bit of a finished run changes unnoticed, and nothing is blamed that is
// whole.
#include "workflows/verification.h"

#include "tests/workflows/program.h"

#include <nlohmann/json.hpp>
#include <random>

namespace sigmaflow::workflows {

namespace {

namespace fs = std::filesystem;

class Verify : public Program {
protected:
    void SetUp() override
    {
        Program::SetUp();
        write("w.json", R"({"suspension": {"particles": 30, "volume_fraction": 0.45},
            "steps": [{"step": "pack"}, {"step": "shear", "stress": 2, "strain": 0.1,
            "frame_interval": 0.05}, {"step": "plot", "width": 320, "height": 240}]})");
        ASSERT_EQ(run("run w.json -q").exit_code, 0);
    }

    std::vector<std::string> files()
    {
        std::vector<std::string> names;
        for (const auto& entry : fs::recursive_directory_iterator(folder / "out/w"))
            if (entry.is_regular_file() && entry.file_size() > 0)
                names.push_back(entry.path().lexically_relative(folder / "out/w").string());
        std::sort(names.begin(), names.end());
        return names;
    }

    void flip(const std::string& name, std::uintmax_t bit)
    {
        std::fstream file(folder / "out/w" / name, std::ios::in | std::ios::out | std::ios::binary);
        file.seekg(static_cast<std::streamoff>(bit / 8));
        const char byte = static_cast<char>(file.get() ^ (1 << bit % 8));
        file.seekp(static_cast<std::streamoff>(bit / 8));
        file.put(byte);
    }

    nlohmann::json verified(int code)
    {
        const Said said = run("verify out/w --json");
        EXPECT_EQ(said.exit_code, code) << said.out << said.err;
        return nlohmann::json::parse(said.out);
    }
};

}

TEST_F(Verify, BlamesNothingInARunThatIsWhole)
{
    const Said said = run("verify out/w");
    EXPECT_EQ(said.exit_code, 0) << said.out << said.err;
    EXPECT_EQ(said.err, "");
    const auto found = verified(0);
    EXPECT_EQ(found["whole"], true);
    EXPECT_EQ(found["files"], files().size());  // .sigmaflow and manifest.json as well
    EXPECT_TRUE(found["unlisted"].empty()) << found;
}

TEST_F(Verify, FindsTwoHundredOfTwoHundredBitsAndNamesTheFile)
{
    std::mt19937 random(20150526);  // the same bits in every run
    const auto names = files();
    for (int k = 0; k < 200; ++k) {
        // every file at least a few times, whatever its size
        const std::string& name = names[static_cast<std::size_t>(k) % names.size()];
        const std::uintmax_t bits = 8 * fs::file_size(folder / "out/w" / name);
        const std::uintmax_t bit = random() % bits;
        flip(name, bit);
        const Verification found = verify_folder(folder / "out/w");
        ASSERT_EQ(found.faults.size(), 1u) << name << " bit " << bit;
        EXPECT_EQ(found.faults[0].file, name) << bit;
        flip(name, bit);
    }
    EXPECT_EQ(verified(0)["faults"].size(), 0u);
}

TEST_F(Verify, NamesWhatIsMissingCutAndUnlisted)
{
    fs::remove(folder / "out/w/shear/series.csv");
    fs::remove(folder / "out/w/.sigmaflow/plot.step");
    fs::resize_file(folder / "out/w/shear/run.h5", 100);
    write("out/w/notes.txt", "mine");
    const Said said = run("verify out/w");
    EXPECT_EQ(said.exit_code, 65);
    for (const char* line :
         {"shear/series.csv: is missing\n", ".sigmaflow/plot.step: is missing\n",
          "shear/run.h5: was changed: it has 100 bytes", "notes.txt: is not listed"})
        EXPECT_NE(said.out.find(line), std::string::npos) << line << "\n" << said.out;
    EXPECT_NE(said.err.find("3 of "), std::string::npos) << said.err;
    EXPECT_EQ(said.err.find("out/w"), said.err.find("out/w: 3 of"));
}

TEST_F(Verify, ChecksTheCheckpointsOfAnInterruptedRun)
{
    write("l.json", R"({"suspension": {"particles": 30, "volume_fraction": 0.45},
        "steps": [{"step": "pack"}, {"step": "shear", "stress": 2, "strain": 1000}]})");
    ASSERT_EQ(run("run l.json -q --out out/w2 --checkpoint-interval 0 --max-walltime 1s").exit_code,
              3);
    fs::remove_all(folder / "out/w");
    fs::rename(folder / "out/w2", folder / "out/w");
    EXPECT_EQ(verified(0)["status"], "interrupted");
    flip(".sigmaflow/checkpoint.0", 1234);
    EXPECT_EQ(verified(65)["faults"][0]["file"], ".sigmaflow/checkpoint.0");
    flip(".sigmaflow/checkpoint.0", 1234);
    flip("shear/series.csv", 800);
    EXPECT_EQ(verified(65)["faults"][0]["file"], "shear/series.csv");
}

TEST_F(Verify, RefusesWhatIsNoFolderOfARun)
{
    EXPECT_EQ(run("verify nowhere").exit_code, 66);
    fs::create_directory(folder / "mine");
    EXPECT_EQ(run("verify mine").exit_code, 65);
    const Said said = run("verify mine --json");
    EXPECT_EQ(nlohmann::json::parse(said.out)["kind"], "input") << said.out;
}

}
