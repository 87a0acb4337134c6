// What of an earlier run is used again, what runs anew and why, and what is refused.
#include "tests/workflows/program.h"

#include <map>

namespace sigmaflow::workflows {

namespace {

struct Flow {
    std::string volume_fraction = "0.45", seed = "1", model = "", stress = "2", strain = "0.1",
                size = "320";
};

std::string text(const Flow& f)
{
    return R"({"suspension": {"particles": 30, "volume_fraction": )" + f.volume_fraction +
           R"(, "seed": )" + f.seed + R"(, "model": {)" + f.model +
           R"(}}, "steps": [{"step": "pack"}, {"step": "shear", "stress": )" + f.stress +
           R"(, "strain": )" + f.strain +
           R"(, "frame_interval": 0.05}, {"step": "plot", "width": )" + f.size +
           R"(, "height": 240}]})";
}

class ResumedRun : public Program {
protected:
    Said run_flow(const Flow& flow, const std::string& options = "")
    {
        write("w.json", text(flow));
        return run("run w.json " + options);
    }

    void expect_in(const Said& said, const std::string& words)
    {
        EXPECT_NE(said.err.find(words), std::string::npos) << words << " is not in\n" << said.err;
    }

    /// All results, without what says when and how long.
    std::map<std::string, std::string> results()
    {
        std::map<std::string, std::string> files;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / "out/w"))
            if (entry.is_regular_file() && entry.path().filename() != "manifest.json" &&
                entry.path().parent_path().filename() != ".sigmaflow")
                files[entry.path().string()] = text_of(entry.path());
        return files;
    }
};

}

TEST_F(ResumedRun, RunsOnlyWhatWasChangedAndWhatFollowsAndSaysWhy)
{
    ASSERT_EQ(run_flow({}).exit_code, 0);
    const auto first = results();
    const Said same = run_flow({});
    expect_in(same, "pack: done, volume fraction 0.45, from an earlier run");
    expect_in(same, "plot: done, from an earlier run");
    EXPECT_EQ(results(), first);

    const Said wider = run_flow({.size = "400"});
    expect_in(wider, "flowing, strain 0.1");
    expect_in(wider, "plot: again, width was 320, is 400");
    EXPECT_EQ(wider.err.find("shear: again"), std::string::npos) << wider.err;

    const Said longer = run_flow({.strain = "0.12", .size = "400"});
    expect_in(longer, "volume fraction 0.45, from an earlier run");
    expect_in(longer, "shear: again, strain was 0.1, is 0.12");
    expect_in(longer, "plot: again, a step before it was changed");

    ASSERT_EQ(run_flow({}).exit_code, 0);  // and back
    EXPECT_EQ(results(), first);
}

TEST_F(ResumedRun, MakesMissingAndChangedResultsAgain)
{
    ASSERT_EQ(run_flow({}).exit_code, 0);
    const auto first = results();
    std::filesystem::remove(folder / "out/w/shear/series.csv");
    expect_in(run_flow({}), "shear: again, shear/series.csv is missing");
    EXPECT_EQ(results(), first);
    write("out/w/plot.svg", "mine now");
    expect_in(run_flow({}), "plot: again, plot.svg was changed");
    EXPECT_EQ(results(), first);
    write("out/w/.sigmaflow/shear.step", "damaged");
    expect_in(run_flow({}), "shear: again, ");
    EXPECT_EQ(results(), first);
}

TEST_F(ResumedRun, SummaryForgetsWhatIsOutOfDateBeforeTheStepRunsAgain)
{
    ASSERT_EQ(run_flow({}).exit_code, 0);
    EXPECT_NE(text_of(folder / "out/w/summary.json").find("\"shear\""), std::string::npos);
    ASSERT_EQ(run_flow({.strain = "1000"}, "--max-walltime 2s").exit_code, 3);
    const std::string summary = text_of(folder / "out/w/summary.json");
    EXPECT_NE(summary.find("\"pack\""), std::string::npos);
    EXPECT_EQ(summary.find("\"shear\""), std::string::npos) << summary;
}

TEST_F(ResumedRun, PanelsFollowEveryPictureTheyShow)
{
    const auto run_figure = [&](const std::string& first, const std::string& second,
                                const std::string& environment = "") {
        const auto plot = [](const std::string& name, const std::string& width) {
            return R"({"step": "plot", "height": 200, "name": ")" + name + R"(", "width": )" +
                   width + "},\n";
        };
        write("w.json", R"({"suspension": {"particles": 30, "volume_fraction": 0.45},
            "steps": [{"step": "pack"}, {"step": "shear", "stress": 2, "strain": 0.1},)" +
                            plot("rate", first) + plot("again", second) + plot("other", "300") +
                            R"({"step": "panels", "of": ["rate", "again"], "width": 400}]})");
        return run("run w.json", environment);
    };
    ASSERT_EQ(run_figure("300", "300").exit_code, 0);
    const auto figure = [&] { return text_of(folder / "out/w/panels.png"); };
    const std::string same_sizes = figure();
    ASSERT_FALSE(same_sizes.empty());
    expect_in(run_figure("300", "300"), "panels: done, from an earlier run");

    const Said second = run_figure("300", "400");
    expect_in(second, "again: again, width was 300, is 400");
    expect_in(second, "panels: again, a step before it was changed");
    expect_in(second, "rate: done, from an earlier run");
    EXPECT_NE(figure(), same_sizes);
    expect_in(run_figure("400", "400"), "panels: again, a step before it was changed");
    ASSERT_EQ(run_figure("300", "300").exit_code, 0);
    EXPECT_EQ(figure(), same_sizes);
}

TEST_F(ResumedRun, PanelsAreMadeAgainWhenAPictureThatFailedCanBeDrawn)
{
    write("w.json", R"({"suspension": {"particles": 30, "volume_fraction": 0.45},
        "steps": [{"step": "pack"}, {"step": "shear", "stress": 2, "strain": 0.1},
                  {"step": "plot", "width": 320, "height": 240},
                  {"step": "snapshot", "width": 320, "height": 240},
                  {"step": "panels", "of": ["plot", "snapshot"], "width": 400}]})");
    const Said blind = run("run w.json", "__EGL_VENDOR_LIBRARY_FILENAMES=/dev/null DISPLAY=");
    EXPECT_EQ(blind.exit_code, 69);
    expect_in(blind, "panels: lacks what could not be drawn: snapshot");
    const std::string lacking = text_of(folder / "out/w/panels.png");
    ASSERT_EQ(run("run w.json").exit_code, 0);
    EXPECT_NE(text_of(folder / "out/w/panels.png"), lacking);
    EXPECT_EQ(text_of(folder / "out/w/summary.json").find("\"without\""), std::string::npos);
}

TEST_F(ResumedRun, AnotherSuspensionInTheSameFolderIsRefusedByName)
{
    ASSERT_EQ(run_flow({}).exit_code, 0);
    const auto first = results();
    struct Case {
        Flow flow;
        const char* words;
    };
    for (const auto& [flow, words] :
         {Case{{.volume_fraction = "0.46"}, "volume_fraction was 0.45, is 0.46"},
          Case{{.seed = "2"}, "seed was 1, is 2"},
          Case{{.model = R"("friction_static": 0.5, "friction_dynamic": 0.5)"},
               "model/friction_static was 1.0, is 0.5"},
          Case{{.model = R"("debye_length": 0.05)"}, "model/debye_length was 0.02, is 0.05"},
          Case{{.model = R"("lubrication_delta": 0.01)"},
               "model/lubrication_delta was 0.001, is 0.01"}}) {
        const Said said = run_flow(flow);
        EXPECT_EQ(said.exit_code, 65);
        expect_in(said, "the folder holds a run of another suspension: ");
        expect_in(said, words);
        expect_in(said, "--out");
        EXPECT_EQ(results(), first);
    }
    EXPECT_EQ(run_flow({.seed = "2"}, "--force").exit_code, 0);
    EXPECT_NE(results(), first);
}

TEST_F(ResumedRun, AnInterruptedStepGoesOnButNotWithOtherParameters)
{
    const Said stopped = run_flow({.strain = "1000"}, "--max-walltime 2s");
    EXPECT_EQ(stopped.exit_code, 3) << stopped.err;
    expect_in(stopped,
              "interrupted: shear: the wall time of 2 s is nearly over; stored at strain ");
    const std::string stored = text_of(folder / "out/w/.sigmaflow/checkpoint.0");

    struct Case {
        Flow flow;
        const char* words;
    };
    for (const auto& [flow, words] :
         {Case{{.stress = "3", .strain = "1000"},
               "the interrupted step shear cannot go on: stress was 2.0, is 3.0"},
          Case{{.strain = "900"}, "strain was 1000.0, is 900.0"},
          Case{{.seed = "2", .strain = "1000"}, "seed was 1, is 2"}}) {
        const Said said = run_flow(flow);
        EXPECT_EQ(said.exit_code, 65);
        expect_in(said, words);
        EXPECT_EQ(text_of(folder / "out/w/.sigmaflow/checkpoint.0"), stored);
    }
    const Said again = run_flow({.strain = "1000", .size = "400"}, "--max-walltime 2s --threads 2");
    EXPECT_EQ(again.exit_code, 3);  // later steps and the number of threads may change
    expect_in(again, "shear: goes on from strain ");
}

}
