// Radii from a file are those written into the workflow, and wrong files say what is wrong where.
#include "tests/workflows/program.h"

#include <array>
#include <nlohmann/json.hpp>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::ordered_json;

/// Ten spheres, with a comment, a blank line and the end of lines of another system.
constexpr const char* radii =
    "# large ones first\n2 # [a]\n1.75\r\n\n  1.5\n1.25\n1\n1\n1e0\n1\n1\n1";
constexpr const char* same_radii = "[2, 1.75, 1.5, 1.25, 1, 1, 1, 1, 1, 1]";

std::string workflow(const std::string& given)
{
    return "{\"suspension\": {\"volume_fraction\": 0.1, " + given + R"(}, "steps": [
        {"step": "pack"}, {"step": "shear", "stress": 1, "strain": 0.05}]})";
}

class RadiiFile : public Program {
protected:
    std::string error_of(const std::string& text)
    {
        write("radii.csv", text);
        write("flow.json", workflow("\"radii_file\": \"radii.csv\""));
        const Said said = run("run -q flow.json");
        EXPECT_EQ(said.exit_code, 65) << said.err;
        EXPECT_FALSE(std::filesystem::exists(folder / "out"));
        return said.err;
    }
};

}

TEST_F(RadiiFile, IsAsGoodAsTheRadiiInTheWorkflow)
{
    std::filesystem::create_directory(folder / "sub");
    write("sub/radii.csv", radii);
    write("sub/file.json", workflow("\"radii_file\": \"radii.csv\""));
    write("list.json", workflow(std::string("\"radii\": ") + same_radii));
    for (const char* name : {"sub/file.json", "list.json"}) {
        const Said said = run(std::string("run -q ") + name);
        ASSERT_EQ(said.exit_code, 0) << said.err;
    }
    EXPECT_EQ(text_of(folder / "out/file/shear/series.csv"),
              text_of(folder / "out/list/shear/series.csv"));
}

TEST_F(RadiiFile, IsNotNeededByTheResolvedWorkflow)
{
    write("radii.csv", radii);
    write("flow.json", workflow("\"radii_file\": \"radii.csv\""));
    ASSERT_EQ(run("run -q flow.json").exit_code, 0);
    const Json resolved = Json::parse(text_of(folder / "out/flow/manifest.json")).at("workflow");
    EXPECT_EQ(resolved["suspension"]["radii"], Json::parse(same_radii));
    EXPECT_FALSE(resolved["suspension"].contains("radii_file"));
    std::filesystem::remove(folder / "radii.csv");
    write("again.json", resolved.dump());
    ASSERT_EQ(run("run -q again.json").exit_code, 0);
    EXPECT_EQ(text_of(folder / "out/flow/shear/series.csv"),
              text_of(folder / "out/again/shear/series.csv"));
}

TEST_F(RadiiFile, WrongOnesAreRefusedWithTheirLine)
{
    struct Wrong {
        const char *text, *message;
    };
    for (const Wrong& wrong :
         {Wrong{"1\n# two\n-1\n",
                "radii.csv:3: must be one number a line, >= 0.01 and <= 100 [a], "
                "got \"-1\""},
          Wrong{"1\n1, 1\n", "radii.csv:2: must be one number a line"},
          Wrong{"1\n1.2 1.4\n", "radii.csv:2: must be one number a line"},
          Wrong{"radius\n1\n1\n", "radii.csv:1: must be one number a line"},
          Wrong{"1\nnan\n", "radii.csv:2: must be one number a line"},
          Wrong{"1\n1e999\n", "radii.csv:2: must be one number a line"},
          Wrong{"1\n0x1p0\n", "radii.csv:2: must be one number a line"},
          Wrong{"1 # alone\n", "radii.csv: must have 2 to 1000000 numbers, got 1"},
          Wrong{"", "radii.csv: must have 2 to 1000000 numbers, got 0"}}) {
        const std::string error = error_of(wrong.text);
        EXPECT_NE(error.find(wrong.message), std::string::npos) << wrong.text << "\n" << error;
    }
}

TEST_F(RadiiFile, ExcludesOtherWordsOnTheSizes)
{
    write("radii.csv", "1\n1\n1\n");
    const std::array<std::array<const char*, 2>, 5> wrong{{
        {"\"radii_file\": \"radii.csv\", \"radii\": [1, 1]",
         "/suspension/radii: radii_file already"},
        {"\"radii_file\": \"radii.csv\", \"size_ratio\": 1.4", "/suspension/size_ratio: radii "},
        {"\"radii_file\": \"radii.csv\", \"particles\": 4",
         "/suspension/particles: must be the number of radii, 3, got 4"},
        {"\"radii_file\": \"none.csv\"", "/suspension/radii_file: must be a file, there is none"},
        {"\"radii_file\": \".\"", "/suspension/radii_file: must be a file, there is none"},
    }};
    for (const auto& [given, message] : wrong) {
        write("flow.json", workflow(given));
        const Said said = run("run -q flow.json");
        EXPECT_EQ(said.exit_code, 65);
        EXPECT_NE(said.err.find(message), std::string::npos) << given << "\n" << said.err;
    }
}

}
