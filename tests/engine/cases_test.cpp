// Configurations with known answers (tests/data/README.md).
#include "io/case_file.h"
#include "tests/support/json_compare.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace sigmaflow {

using nlohmann::json;

namespace {

const std::filesystem::path folder = std::filesystem::path(SIGMAFLOW_TEST_DATA) / "cases";

json stored(const std::string& name)
{
    std::ifstream file(folder / (name + ".json"));
    return json::parse(file);
}

json computed(const std::string& name)
{
    return json::parse(io::evaluate_case(folder / (name + ".json")));
}

std::vector<std::string> names_starting_with(char first)
{
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (const std::string name = entry.path().stem(); name[0] == first && name != "pairs")
            names.push_back(name);
    std::sort(names.begin(), names.end());
    return names;
}

std::string test_name(const testing::TestParamInfo<std::string>& info)
{
    return info.param;
}

}

class InstantCase : public testing::TestWithParam<std::string> {};

TEST_P(InstantCase, AgreesWithTheKnownAnswer)
{
    const json expected = stored(GetParam()).at("expected");
    const support::Deviation worst =
        support::deviation(expected, computed(GetParam()).at("expected"));
    EXPECT_LT(worst.value, 1e-9) << worst.where;
}

INSTANTIATE_TEST_SUITE_P(Cases, InstantCase, testing::ValuesIn(names_starting_with('c')),
                         test_name);

TEST(PairCases, AgreeWithTheKnownAnswers)
{
    const json cases = stored("pairs").at("cases"), answers = computed("pairs").at("cases");
    ASSERT_EQ(cases.size(), answers.size());
    for (std::size_t k = 0; k < cases.size(); ++k) {
        const support::Deviation worst =
            support::deviation(cases[k].at("expected"), answers[k].at("expected"));
        EXPECT_LT(worst.value, 1e-12) << k << worst.where;
    }
}

class TrajectoryCase : public testing::TestWithParam<std::string> {};

// The stored values are converged in the step; ours takes the middle step, whose error is stored.
TEST_P(TrajectoryCase, ConvergesToTheKnownAnswer)
{
    const json expected = stored(GetParam()).at("expected");
    const json answer = computed(GetParam()).at("expected");
    const auto value = expected.at("value").get<std::vector<double>>();
    const auto ours = answer.at("value").get<std::vector<double>>();
    ASSERT_EQ(value.size(), ours.size());
    double largest = 0, error = 0;
    for (std::size_t k = 0; k < value.size(); ++k) {
        largest = std::max(largest, std::abs(value[k]));
        error = std::max(error, std::abs(value[k] - ours[k]));
    }
    EXPECT_LT(error / largest, 3 * expected.at("middle_error").get<double>());
    EXPECT_EQ(expected.at("contacts"), answer.at("contacts"));
}

INSTANTIATE_TEST_SUITE_P(Cases, TrajectoryCase, testing::ValuesIn(names_starting_with('t')),
                         test_name);

}
