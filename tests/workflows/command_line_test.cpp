// The command line: what goes to stdout and stderr, and the exit codes.
#include "tests/workflows/program.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace sigmaflow::workflows {

namespace {

bool contains(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

constexpr const char* packing = R"({"suspension": {"particles": 12, "size_ratio": 1,
    "volume_fraction": 0.2}, "steps": [{"step": "pack"}]})";

}

class CommandLine : public Program {
protected:
    /// Exit code, nothing on stdout, and one line of error that begins as it should.
    void expect_error(const std::string& arguments, int code, const std::string& phrase)
    {
        const Said said = run(arguments);
        EXPECT_EQ(said.exit_code, code) << arguments << "\n" << said.err;
        EXPECT_EQ(said.out, "") << arguments;
        EXPECT_EQ(said.err.rfind("sigmaflow: error: ", 0), 0u) << said.err;
        EXPECT_TRUE(contains(said.err, phrase)) << arguments << "\n" << said.err;
    }
};

TEST_F(CommandLine, HelpAndVersionAreResults)
{
    for (const char* arguments :
         {"", "--help", "run --help", "--version", "explain", "explain shear"}) {
        const Said said = run(arguments);
        EXPECT_EQ(said.exit_code, 0) << arguments;
        EXPECT_EQ(said.err, "") << arguments;
        EXPECT_FALSE(said.out.empty()) << arguments;
    }
    EXPECT_EQ(run("--version").out, "sigmaflow " SIGMAFLOW_VERSION "\n");
    EXPECT_TRUE(contains(run("--help").out, "sigmaflow run workflows/quickstart.json"));
    EXPECT_TRUE(contains(run("explain shear").out, "stress [sigma0]"));
}

TEST_F(CommandLine, WrongUsageIs64)
{
    expect_error("--bogus", 64, "--bogus");
    expect_error("runn", 64, "runn");
    expect_error("run", 64, "WORKFLOW.json");
    expect_error("run a.json --bogus", 64, "--bogus");
    expect_error("run a.json b.json", 64, "b.json");
    expect_error("run a.json --out", 64, "--out");
    expect_error("explain sheer", 64, "did you mean \"shear\"?");
    expect_error("evaluate", 64, "CASE.json");
}

TEST_F(CommandLine, MissingInputIs66)
{
    expect_error("run nothing.json", 66, "nothing.json: cannot be read: No such file");
    expect_error("run .", 66, "is a folder, not a file");
    expect_error("run /dev/zero", 66, "is not a regular file");
    expect_error("evaluate nothing.json", 66, "nothing.json: cannot be read: No such file");
}

TEST_F(CommandLine, InvalidInputIs65AndNothingIsWritten)
{
    write("wrong.json", "{\"suspension\": {},\n \"steps\": [{\"step\": \"shear\"}]}");
    expect_error("run wrong.json", 65, "wrong.json:2:12: /steps/0: needs");
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
    write("deep.json", std::string(100'000, '['));
    expect_error("run deep.json", 65, "deep.json:1:65: nested deeper than 64");
    expect_error("evaluate wrong.json", 65, "wrong.json:1:");
}

TEST_F(CommandLine, FolderOfSomethingElseIs73AndUntouched)
{
    const auto workflow = write("w.json", packing);
    std::filesystem::create_directories(folder / "mine");
    write("mine/thesis.txt", "precious");
    expect_error("run w.json --out mine", 73, "is not empty and holds no earlier run");
    EXPECT_EQ(text_of(folder / "mine/thesis.txt"), "precious");
    EXPECT_FALSE(std::filesystem::exists(folder / "mine/manifest.json"));

    write("mine/manifest.json", R"({"files": ["thesis.txt"]})");  // not one of ours
    std::filesystem::create_directories(folder / "mine/.sigmaflow");
    expect_error("run w.json --out mine", 73, "not one of sigmaflow");
    EXPECT_EQ(text_of(folder / "mine/thesis.txt"), "precious");
    expect_error("run w.json --out w.json", 73, "is not a folder");
    expect_error("run w.json --out /proc/nowhere", 73, "cannot make the folder");
}

TEST_F(CommandLine, EarlierRunOfTheSameWorkflowIsUsedAndOtherFilesStay)
{
    write("w.json", packing);
    ASSERT_EQ(run("run w.json").exit_code, 0);
    write("out/w/notes.txt", "mine");
    const std::string first = text_of(folder / "out/w/pack/state.json");
    const Said again = run("run w.json");
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_TRUE(contains(again.err, "from an earlier run")) << again.err;
    const Said forced = run("run w.json --force");
    EXPECT_EQ(forced.exit_code, 0) << forced.err;
    EXPECT_TRUE(contains(forced.err, "again, --force")) << forced.err;
    EXPECT_EQ(text_of(folder / "out/w/pack/state.json"), first);
    EXPECT_EQ(text_of(folder / "out/w/notes.txt"), "mine");

    write("other.json", packing);
    expect_error("run other.json --out out/w", 73, "holds a run of another workflow, \"w\"");
}

TEST_F(CommandLine, LinksInTheFolderLeadNothingElsewhere)
{
    write("w.json", packing);
    std::filesystem::create_directories(folder / "elsewhere");
    ASSERT_EQ(run("run w.json").exit_code, 0);
    std::filesystem::remove_all(folder / "out/w/pack");
    std::filesystem::create_directory_symlink(folder / "elsewhere", folder / "out/w/pack");
    expect_error("run w.json -q", 73, "out/w/pack: is a symbolic link");
    EXPECT_TRUE(std::filesystem::is_empty(folder / "elsewhere"));
    std::filesystem::remove(folder / "out/w/pack");
    std::filesystem::remove_all(folder / "out/w/.sigmaflow");
    std::filesystem::create_directory_symlink(folder / "elsewhere", folder / "out/w/.sigmaflow");
    expect_error("run w.json -q", 73, ".sigmaflow: is a symbolic link");
    EXPECT_TRUE(std::filesystem::is_empty(folder / "elsewhere"));
}

TEST_F(CommandLine, FolderThatAnotherProcessWritesToIs75)
{
    write("w.json", packing);
    ASSERT_EQ(run("run w.json --out used").exit_code, 0);
    const int other = open((folder / "used").c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    ASSERT_EQ(flock(other, LOCK_EX | LOCK_NB), 0);
    expect_error("run w.json --out used", 75, " is writing to this folder");
    close(other);
    EXPECT_EQ(run("run w.json --out used").exit_code, 0);
}

TEST_F(CommandLine, QuietSaysNothingButResults)
{
    write("w.json", packing);
    EXPECT_EQ(run("run w.json -q").err, "");
    EXPECT_TRUE(contains(run("run w.json").err, "[1/1] pack"));
    EXPECT_FALSE(contains(run("run w.json").err, "\033"));  // stderr is no terminal here
}

TEST_F(CommandLine, FullStandardOutputIsAnError)
{
    const std::string command = std::string("'") + SIGMAFLOW_PROGRAM + "' explain >/dev/full 2>&1";
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 73);
}

}
