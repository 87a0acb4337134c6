// Runs the program sigmaflow as a user does and keeps what it says.
#pragma once
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace sigmaflow::workflows {

inline std::string text_of(const std::filesystem::path& path)
{
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

struct Said {
    int exit_code = -1;  // 128 + n if signal n ended the program
    std::string out, err;
};

/// A folder of its own for every test, in which the program runs.
class Program : public testing::Test {
protected:
    void SetUp() override
    {
        std::string pattern = testing::TempDir() + "sigmaflow_XXXXXX";
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        folder = pattern;
    }
    void TearDown() override { std::filesystem::remove_all(folder); }

    std::filesystem::path write(const std::string& name, const std::string& text)
    {
        std::ofstream(folder / name, std::ios::binary) << text;
        return folder / name;
    }

    /// `arguments` and `environment` (NAME=value ...) are words of the shell.
    Said run(const std::string& arguments, const std::string& environment = "")
    {
        const std::string command = "cd '" + folder.string() + "' && env " + environment + " '" +
                                    SIGMAFLOW_PROGRAM + "' " + arguments +
                                    " >said.out 2>said.err </dev/null";
        const int status = std::system(command.c_str());
        const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
        return {code, text_of(folder / "said.out"), text_of(folder / "said.err")};
    }

    std::filesystem::path folder;
};

}
