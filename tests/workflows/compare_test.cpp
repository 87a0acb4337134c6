// sigmaflow compare: the first difference is found where it is.
#include "tests/workflows/program.h"

#include <nlohmann/json.hpp>

namespace sigmaflow::workflows {

namespace {

class Compare : public Program {
protected:
    void flow(const std::string& name, const std::string& seed, const std::string& more = "",
              const std::string& options = "")
    {
        write(name + ".json", R"({"name": "one", "suspension": {"particles": 30,
            "volume_fraction": 0.45, "seed": )" +
                                  seed + R"(}, "steps": [{"step": "pack"}, {"step": "shear",
            "stress": 2, "strain": 0.2)" +
                                  more + "}]}");
        ASSERT_EQ(run("run " + name + ".json -q " + options).exit_code, 0);
    }

    nlohmann::json compared(const std::string& arguments, int code)
    {
        const Said said = run("compare --json " + arguments);
        EXPECT_EQ(said.exit_code, code) << arguments << said.out << said.err;
        return nlohmann::json::parse(said.out);
    }
};

}

TEST_F(Compare, ThreadsAndRepetitionsAreEqualBitByBit)
{
    flow("a", "1");
    flow("b", "1", "", "--threads 2");
    const auto found = compared("out/a out/b", 0);
    EXPECT_EQ(found["equal"], true);
    EXPECT_TRUE(found["parameters"].empty()) << found;
    EXPECT_EQ(found["series"][0]["common"], 21);
    compared("out/a/shear/run.h5 out/b/shear/series.csv", 0);
    compared("out/a/summary.json out/b/summary.json", 0);
}

TEST_F(Compare, ASingleEditedValueIsFoundAtItsRowAndWithinItsTolerance)
{
    flow("a", "1");
    // row 7 (strain 0.07), shear rate: one part in a thousand more
    std::istringstream lines(text_of(folder / "out/a/shear/series.csv"));
    std::string edited;
    for (int k = 0; std::getline(lines, edited, '\n') && k < 9; ++k)
        write("edited.csv", text_of(folder / "edited.csv") + edited + "\n");
    const std::size_t comma = edited.find(',', edited.find(',') + 1) + 1;
    const std::size_t end = edited.find(',', comma);
    const double rate = std::stod(edited.substr(comma, end - comma));
    std::ostringstream number;
    number.precision(17);
    number << rate * 1.001;
    std::string rest((std::istreambuf_iterator<char>(lines)), {});
    write("edited.csv", text_of(folder / "edited.csv") + edited.substr(0, comma) + number.str() +
                            edited.substr(end) + "\n" + rest);

    const auto found = compared("out/a/shear/series.csv edited.csv", 1);
    ASSERT_EQ(found["series"][0]["quantities"].size(), 1u) << found;
    const auto& quantity = found["series"][0]["quantities"][0];
    EXPECT_EQ(quantity["name"], "shear_rate");
    EXPECT_EQ(quantity["row"], 7);
    EXPECT_EQ(quantity["rows"], 1);
    EXPECT_EQ(quantity["strain"], 0.07);
    EXPECT_EQ(quantity["a"], rate);
    EXPECT_NEAR(quantity["largest_relative_difference"].get<double>(), 1e-3, 1e-5);
    compared("out/a/shear/series.csv edited.csv --tolerance 2e-3", 0);
    compared("out/a/shear/series.csv edited.csv --tolerance 5e-4", 1);
    const Said said = run("compare out/a/shear/series.csv edited.csv");
    EXPECT_NE(said.err.find("differ: shear_rate of series.csv from strain 0.07 on"),
              std::string::npos)
        << said.err;
    EXPECT_NE(said.out.find("\ndifferent\n"), std::string::npos) << said.out;
}

TEST_F(Compare, SeedsDifferFromTheFirstRowAndTheParameterIsNamed)
{
    flow("a", "1");
    flow("b", "2");
    const auto found = compared("out/a out/b", 1);
    ASSERT_EQ(found["parameters"].size(), 1u) << found;
    EXPECT_EQ(found["parameters"][0]["place"], "/suspension/seed");
    EXPECT_EQ(found["parameters"][0]["a"], 1);
    EXPECT_EQ(found["parameters"][0]["b"], 2);
    EXPECT_EQ(found["series"][0]["quantities"][0]["row"], 0);
    EXPECT_FALSE(found["results"].empty());
}

TEST_F(Compare, AnotherIntervalIsComparedAtCommonStrainsAndALongerRunDiffers)
{
    flow("a", "1");
    flow("c", "1", R"(, "series_interval": 0.02)");
    const Said said = run("compare --json out/a/shear/series.csv out/c/shear/series.csv");
    const auto coarse = nlohmann::json::parse(said.out);
    EXPECT_EQ(coarse["series"][0]["common"], 11);
    EXPECT_EQ(coarse["series"][0]["end_a"], coarse["series"][0]["end_b"]);
    std::string shorter = text_of(folder / "out/a/shear/series.csv");
    shorter.resize(shorter.rfind('\n', shorter.size() - 2) + 1);
    write("shorter.csv", shorter);
    const auto found = compared("out/a/shear/series.csv shorter.csv", 1);
    EXPECT_TRUE(found["series"][0]["quantities"].empty());
    EXPECT_EQ(found["series"][0]["end_b"], 0.19);
}

TEST_F(Compare, WhatCannotBeComparedIsRefused)
{
    flow("a", "1");
    EXPECT_EQ(compared("out/a nowhere", 66)["kind"], "missing");
    EXPECT_EQ(compared("out/a out/a/summary.json", 65)["kind"], "input");
    write("text.txt", "no run");
    EXPECT_EQ(compared("text.txt text.txt", 65)["kind"], "input");
    write("broken.h5", std::string("\x89HDF\r\n\x1a\n", 8) + std::string(100, 'x'));
    EXPECT_EQ(compared("broken.h5 broken.h5", 65)["kind"], "input");
    EXPECT_EQ(run("compare out/a out/a --tolerance -1").exit_code, 64);
}

}
