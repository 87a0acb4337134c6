// Workflow files that are right: shipped ones, defaults, names of steps, and the resolved form.
#include "workflows/workflow.h"

#include "io/atomic_file.h"
#include "workflows/steps.h"

#include <gtest/gtest.h>
#include <filesystem>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::ordered_json;

std::vector<std::filesystem::path> shipped_workflows()
{
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(SIGMAFLOW_WORKFLOWS))
        if (entry.path().extension() == ".json" &&
            !entry.path().stem().string().ends_with(".schema"))
            files.push_back(entry.path());
    return files;
}

}

TEST(Workflow, EveryShippedFileIsValid)
{
    const auto files = shipped_workflows();
    EXPECT_GE(files.size(), 4u);
    for (const auto& file : files) EXPECT_NO_THROW(read_workflow(file)) << file;
}

TEST(Workflow, ResolvedParametersAreAWorkflowThatResolvesToItself)
{
    for (const auto& file : shipped_workflows()) {
        const Json once = read_workflow(file).resolved();
        const Json twice =
            parse_workflow(once.dump(), file.parent_path() / "resolved.json").resolved();
        EXPECT_EQ(once, twice) << file;
    }
}

TEST(Workflow, ResolvedParametersHoldWhatTheFileSaysAndTheDefaultsOfTheRest)
{
    const Json resolved =
        parse_workflow(R"({"suspension": {"particles": 1e2, "seed": 18446744073709551615,
                           "model": {"friction_static": 2, "contact_hydrodynamics": "dashpot"}},
                           "steps": [{"step": "pack"},
                                     {"step": "shear", "stress": 0.1, "scheme": "heun"}]})",
                       "test.json")
            .resolved();
    EXPECT_EQ(resolved["name"], "test");
    EXPECT_EQ(resolved["suspension"]["particles"], 100);
    EXPECT_EQ(resolved["suspension"]["seed"], 18446744073709551615u);
    EXPECT_EQ(resolved["suspension"]["size_ratio"], 1.4);
    EXPECT_EQ(resolved["suspension"]["model"]["friction_static"], 2);
    EXPECT_EQ(resolved["suspension"]["model"]["contact_hydrodynamics"], "dashpot");
    EXPECT_EQ(resolved["suspension"]["model"]["debye_length"], 0.02);
    EXPECT_EQ(resolved["steps"][1]["stress"], 0.1);
    EXPECT_EQ(resolved["steps"][1]["scheme"], "heun");
    EXPECT_EQ(resolved["steps"][1]["solver"], "pcg");
    EXPECT_FALSE(resolved["steps"][1].contains("rate"));
}

TEST(Workflow, GivenRadiiReplaceTheMixture)
{
    const Json resolved =
        parse_workflow(R"({"suspension": {"volume_fraction": 0.04, "radii": [1, 1.5, 2]},
                                             "steps": [{"step": "pack"}]})",
                       "test.json")
            .resolved();
    EXPECT_EQ(resolved["suspension"]["particles"], 3);
    EXPECT_EQ(parse_workflow(resolved.dump(), "again.json").resolved(), resolved);
}

TEST(Workflow, StepsAreNamedAfterTheirKindAndNamesAreUnique)
{
    const Workflow workflow = parse_workflow(R"({"suspension": {}, "steps": [
        {"step": "pack"}, {"step": "shear", "stress": 1}, {"step": "shear", "stress": 2},
        {"step": "shear", "stress": 3, "name": "shear_2"}, {"step": "plot", "of": "shear_3"},
        {"step": "plot"}]})",
                                             "test.json");
    std::vector<std::string> names;
    for (const Step& step : workflow.steps) names.push_back(step.name);
    EXPECT_EQ(names,
              (std::vector<std::string>{"pack", "shear", "shear_3", "shear_2", "plot", "plot_2"}));
    const Json resolved = workflow.resolved();
    EXPECT_EQ(resolved["steps"][4]["of"], "shear_3");
    EXPECT_EQ(resolved["steps"][5]["of"], "shear_2");  // the last run before it
}

TEST(Workflow, ASweepStandsForOneStepPerValue)
{
    const Workflow workflow = parse_workflow(R"({"suspension": {}, "steps": [{"step": "pack"},
        {"step": "shear", "name": "up", "sweep": {"stress": [0.5, 1, 20]}, "strain": 2},
        {"step": "shear", "sweep": {"displacement": [0.01, 0.005]}, "stress": 3},
        {"step": "plot", "sweep": {"y": ["viscosity", "contact_number"]}, "of": "up_0.5"}]})",
                                             "test.json");
    std::vector<std::string> names;
    for (const Step& step : workflow.steps) names.push_back(step.name);
    EXPECT_EQ(names,
              (std::vector<std::string>{"pack", "up_0.5", "up_1", "up_20", "shear_0.01",
                                        "shear_0.005", "plot_viscosity", "plot_contact_number"}));
    const Json steps = workflow.resolved()["steps"];
    EXPECT_EQ(steps[1]["stress"], 0.5);
    EXPECT_EQ(steps[3]["stress"], 20);
    EXPECT_EQ(steps[3]["strain"], 2);
    EXPECT_EQ(steps[5]["displacement"], 0.005);
    EXPECT_EQ(steps[7]["y"], "contact_number");
    EXPECT_FALSE(steps[1].contains("sweep"));
}

TEST(Workflow, ARateCanBeImposedWithFixedStiffness)
{
    EXPECT_NO_THROW(parse_workflow(R"({"suspension": {"model": {"stiffness_scale": "fixed"}},
        "steps": [{"step": "pack"}, {"step": "shear", "rate": 0.5}]})",
                                   "test.json"));
}

}
