// sigmaflow completion: a real bash completes what the program has declared.
#include "tests/workflows/program.h"

#include <set>

namespace sigmaflow::workflows {

namespace {

class Completion : public Program {
protected:
    /// What bash offers for the last of these words.
    std::set<std::string> offered(const std::vector<std::string>& words)
    {
        std::string line = "sigmaflow";
        for (const std::string& word : words) line += " '" + word + "'";
        write("complete.sh", "source <('" SIGMAFLOW_PROGRAM
                             "' completion bash)\n"
                             "COMP_WORDS=(" +
                                 line + ")\nCOMP_CWORD=" + std::to_string(words.size()) +
                                 "\n_sigmaflow\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n");
        const std::string command =
            "cd '" + folder.string() + "' && bash complete.sh >offered.txt 2>offered.err";
        EXPECT_EQ(std::system(command.c_str()), 0);
        EXPECT_EQ(text_of(folder / "offered.err"), "");
        std::istringstream lines(text_of(folder / "offered.txt"));
        std::set<std::string> result;
        for (std::string one; std::getline(lines, one);)
            if (!one.empty()) result.insert(one);
        return result;
    }
};

using Offers = std::set<std::string>;

}

TEST_F(Completion, OffersCommandsOptionsAndSteps)
{
    EXPECT_EQ(offered({"sta"}), Offers{"status"});
    EXPECT_TRUE(offered({""}).contains("run"));
    EXPECT_EQ(offered({"--v"}), Offers{"--version"});
    EXPECT_EQ(offered({"run", "--ma"}), Offers{"--max-walltime"});
    EXPECT_EQ(offered({"run", "--th"}), Offers{"--threads"});
    EXPECT_EQ(offered({"compare", "--to"}), Offers{"--tolerance"});
    EXPECT_TRUE(offered({"status", "--to"}).empty());
    EXPECT_EQ(offered({"explain", "velocity_profile.bi"}), Offers{"velocity_profile.bins"});
    EXPECT_TRUE(offered({"explain", "velo"}).contains("velocity_profile"));
    EXPECT_EQ(offered({"completion", ""}), (Offers{"bash", "fish", "zsh"}));
}

TEST_F(Completion, OffersFilesAndFoldersWithBlanksInTheirNames)
{
    write("my flow.json", "{}");
    std::filesystem::create_directories(folder / "my results");
    EXPECT_EQ(offered({"run", "my f"}), Offers{"my flow.json"});
    EXPECT_EQ(offered({"run", "w.json", "--out", "my"}), Offers{"my results"});
    EXPECT_EQ(offered({"status", "my"}), Offers{"my results"});
}

TEST_F(Completion, HasEveryCommandForEveryShell)
{
    for (const char* shell : {"bash", "zsh", "fish"}) {
        const Said said = run(std::string("completion ") + shell);
        EXPECT_EQ(said.exit_code, 0);
        for (const char* word : {"status", "max-walltime", "velocity_profile", "completion"})
            EXPECT_NE(said.out.find(word), std::string::npos) << shell << " " << word;
    }
    EXPECT_EQ(run("completion tcsh").exit_code, 64);
}

}
