// The workflows that make the figures of the paper: the large ones are valid, the small ones run.
#include "tests/workflows/program.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace sigmaflow::workflows {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

std::vector<std::string> workflows(bool small)
{
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(SIGMAFLOW_WORKFLOWS "/paper")) {
        const std::string name = entry.path().stem().string();
        if (entry.path().extension() == ".json" && name.ends_with("_small") == small)
            names.push_back(name);
    }
    std::sort(names.begin(), names.end());
    return names;
}

std::string path_of(const std::string& name)
{
    return std::string(SIGMAFLOW_WORKFLOWS "/paper/") + name + ".json";
}

/// A table of numbers must not say otherwise.
bool has_only_finite_numbers(const std::string& table)
{
    return table.find(",nan") == std::string::npos && table.find(",-nan") == std::string::npos &&
           table.find(",inf") == std::string::npos && table.find(",-inf") == std::string::npos;
}

class Figure : public Program, public testing::WithParamInterface<std::string> {};
class SmallFigure : public Figure {};

}

TEST_P(Figure, IsValid)
{
    const Said said = run("validate '" + path_of(GetParam()) + "'");
    EXPECT_EQ(said.exit_code, 0) << said.err;
}

TEST_P(SmallFigure, IsMadeByOneCommand)
{
    const Said said = run("run -q '" + path_of(GetParam()) + "'");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    const fs::path out = folder / "out" / GetParam();
    EXPECT_TRUE(Json::accept(text_of(out / "summary.json")));
    const Json manifest = Json::parse(text_of(out / "manifest.json"));
    EXPECT_EQ(manifest["status"], "complete");
    std::size_t pictures = 0;
    for (const auto& entry : fs::directory_iterator(out)) {
        pictures += entry.path().extension() == ".png";
        if (entry.path().extension() == ".csv") {
            EXPECT_TRUE(has_only_finite_numbers(text_of(entry.path()))) << entry.path();
        }
    }
    EXPECT_GT(pictures, 0u);
}

INSTANTIATE_TEST_SUITE_P(Paper, Figure, testing::ValuesIn(workflows(false)),
                         [](const auto& info) { return info.param; });
INSTANTIATE_TEST_SUITE_P(Paper, SmallFigure, testing::ValuesIn(workflows(true)),
                         [](const auto& info) { return info.param; });

}
