// A small workflow from the JSON file to the pictures, through the program.
#include "tests/workflows/program.h"

#include "io/run_file.h"
#include "io/series_csv.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::json;

constexpr const char* small = R"({
  "name": "small",
  "suspension": {"particles": 30, "volume_fraction": 0.4, "size_ratio": 1, "seed": 3},
  "steps": [
    {"step": "pack"},
    {"step": "equilibrate", "stress": 2, "minimum_strain": 0.08, "window": 0.04,
     "maximum_strain": 0.1},
    {"step": "shear", "stress": 2, "strain": 0.1, "frame_interval": 0.05},
    {"step": "velocity_profile", "bins": 6, "spacing": 0.05},
    {"step": "snapshot", "width": 320, "height": 180},
    {"step": "plot", "name": "rate", "width": 640, "height": 360}
  ]
})";

class SmallRun : public Program {
protected:
    Json json(const std::string& name) { return Json::parse(text_of(folder / name)); }
};

}

TEST_F(SmallRun, LeavesEveryPromisedFile)
{
    write("small.json", small);
    const Said said = run("run small.json");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    for (const char* name : {"manifest.json",
                             "summary.json",
                             "pack/state.json",
                             "equilibrate/series.csv",
                             "equilibrate/run.h5",
                             "equilibrate/state.json",
                             "shear/series.csv",
                             "shear/run.h5",
                             "shear/state.json",
                             "shear/particles.pvd",
                             "shear/view.py",
                             "shear/contacts.pvd",
                             "shear/vtk/particles_00000.vtp",
                             "shear/vtk/particles_00001.vtp",
                             "shear/vtk/particles_00002.vtp",
                             "shear/vtk/contacts_00002.vtp",
                             "velocity_profile.csv",
                             "velocity_profile.png",
                             "velocity_profile.svg",
                             "snapshot.png",
                             "rate.png",
                             "rate.svg"}) {
        const auto path = folder / "out/small" / name;
        EXPECT_TRUE(std::filesystem::exists(path) && std::filesystem::file_size(path) > 0) << name;
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "out/small/shear/vtk/particles_00003.vtp"));
    EXPECT_NE(said.out.find("viscosity"), std::string::npos);

    const Json manifest = json("out/small/manifest.json");
    EXPECT_EQ(manifest["status"], "complete");
    EXPECT_EQ(manifest["seed"], 3);
    EXPECT_EQ(manifest["sigmaflow"], SIGMAFLOW_VERSION);
    EXPECT_EQ(manifest["steps"].size(), 6u);
    EXPECT_EQ(manifest["workflow"]["suspension"]["model"]["debye_length"], 0.02);
    for (const char* key : {"host", "cores", "compiler", "started", "ended", "libraries"})
        EXPECT_FALSE(manifest[key].is_null()) << key;
    std::size_t listed = 0;
    for (const Json& file : manifest["files"]) {
        const auto path = folder / "out/small" / file["name"].get<std::string>();
        EXPECT_EQ(std::filesystem::file_size(path), file["size"].get<std::uintmax_t>()) << path;
        ++listed;
    }
    std::size_t found = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / "out/small"))
        if (entry.is_regular_file() && entry.path().parent_path().filename() != ".sigmaflow")
            ++found;
    EXPECT_EQ(listed + 3, found);  // manifest, summary and resolved workflow are not in the list
}

TEST_F(SmallRun, SummaryHoldsMeansOfTheSeriesAfterTheStartUp)
{
    write("small.json", small);
    ASSERT_EQ(run("run small.json -q").exit_code, 0);
    const Json shear = json("out/small/summary.json")["steps"]["shear"];
    const auto series = io::read_series(folder / "out/small/shear/series.csv");
    ASSERT_EQ(series.size(), 11u);
    double rate = 0, first_time = 0;
    int count = 0;
    for (std::size_t i = 0; i < series.size(); ++i) {
        EXPECT_NEAR(series[i].strain, 0.01 * static_cast<double>(i), 1e-15);
        EXPECT_NEAR(series[i].shear_stress, 2, 1e-9);
        if (series[i].strain < shear["averages_from_strain"].get<double>() - 1e-9) continue;
        if (count++ == 0) first_time = series[i].time;
        rate += series[i].shear_rate;
    }
    rate /= count;
    EXPECT_NEAR(shear["shear_rate"]["mean"].get<double>(), rate, 1e-12 * rate);
    EXPECT_NEAR(shear["viscosity"]["mean"].get<double>(), 2 / rate, 1e-9 / rate);
    const double over_time =
        (0.1 - shear["averages_from_strain"].get<double>()) / (series.back().time - first_time);
    EXPECT_NEAR(shear["shear_rate_time_average"]["mean"].get<double>(), over_time,
                1e-9 * over_time);
    EXPECT_EQ(shear["outcome"], "flowing");
    EXPECT_EQ(shear["control"]["stress"], 2);
    for (const char* key : {"viscosity", "shear_rate", "normal_stress_difference_1",
                            "normal_stress_difference_2", "particle_pressure", "contact_number"}) {
        EXPECT_TRUE(shear[key]["mean"].is_number()) << key;
        EXPECT_TRUE(shear[key]["standard_error"].is_number()) << key;
    }
    const Json profile = json("out/small/summary.json")["steps"]["velocity_profile"];
    for (const char* key : {"rms_deviation", "largest_deviation", "slope", "profiles"})
        EXPECT_TRUE(profile.contains(key)) << key;
}

TEST_F(SmallRun, SeriesFileAndHdf5FileHoldTheSameNumbers)
{
    write("small.json", small);
    ASSERT_EQ(run("run small.json -q").exit_code, 0);
    const auto rows = io::read_series(folder / "out/small/shear/series.csv");
    const auto stored = io::read_run(folder / "out/small/shear/run.h5");
    ASSERT_EQ(rows.size(), stored.series.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
        for (const SampleField& field : sample_fields())
            EXPECT_EQ(rows[i].*field.value, stored.series[i].*field.value) << field.name;
    ASSERT_EQ(stored.frames.size(), 3u);
    EXPECT_NEAR(stored.frames[1].state.strain, 0.05, 1e-15);
    EXPECT_NE(stored.provenance.at("workflow").find("\"seed\":3"), std::string::npos);
}

TEST_F(SmallRun, IsTheSameWithTheSameSeedAndAnotherWithAnotherSeed)
{
    write("small.json", small);
    ASSERT_EQ(run("run small.json -q --out one").exit_code, 0);
    ASSERT_EQ(run("run small.json -q --out two").exit_code, 0);
    EXPECT_EQ(text_of(folder / "one/shear/series.csv"), text_of(folder / "two/shear/series.csv"));
    EXPECT_EQ(text_of(folder / "one/shear/vtk/particles_00002.vtp"),
              text_of(folder / "two/shear/vtk/particles_00002.vtp"));
    std::string other = small;
    other.replace(other.find("\"seed\": 3"), 9, "\"seed\": 4");
    write("small.json", other);
    ASSERT_EQ(run("run small.json -q --out three").exit_code, 0);
    EXPECT_NE(text_of(folder / "one/shear/series.csv"), text_of(folder / "three/shear/series.csv"));
}

TEST_F(SmallRun, FailureToRenderCostsThePicturesOnlyAndEndsWith69)
{
    write("small.json", small);
    ASSERT_EQ(run("run small.json -q --out good").exit_code, 0);
    const Said said =
        run("run small.json --out bad", "__EGL_VENDOR_LIBRARY_FILENAMES=/dev/null DISPLAY=");
    EXPECT_EQ(said.exit_code, 69) << said.err;
    EXPECT_NE(said.err.find("all other results are complete"), std::string::npos) << said.err;
    EXPECT_NE(said.out.find("viscosity"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(folder / "bad/snapshot.png"));
    for (const char* name : {"shear/series.csv", "shear/particles.pvd", "velocity_profile.csv",
                             "velocity_profile.svg", "rate.svg", "summary.json"})
        EXPECT_EQ(text_of(folder / "bad" / name), text_of(folder / "good" / name)) << name;
    EXPECT_EQ(json("bad/manifest.json")["status"], "pictures missing");
}

TEST_F(SmallRun, StateFileIsAConfigurationThatEvaluateUnderstands)
{
    write("small.json", small);
    ASSERT_EQ(run("run small.json -q").exit_code, 0);
    const Said said = run("evaluate out/small/shear/state.json");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    const Json expected = Json::parse(said.out)["expected"];
    const auto series = io::read_series(folder / "out/small/shear/series.csv");
    EXPECT_NEAR(expected["shear_rate"].get<double>(), series.back().shear_rate,
                1e-9 * std::abs(series.back().shear_rate));
    EXPECT_NEAR(expected["shear_stress"].get<double>(), 2, 1e-9);
}

TEST_F(SmallRun, ARateIsImposedWithFixedStiffness)
{
    write("rate.json", R"({"suspension": {"particles": 30, "volume_fraction": 0.4, "size_ratio": 1,
        "model": {"stiffness_scale": "fixed", "normal_stiffness": 2000, "tangential_stiffness": 1000}},
        "steps": [{"step": "pack"}, {"step": "shear", "rate": 0.5, "strain": 0.05}]})");
    ASSERT_EQ(run("run rate.json -q").exit_code, 0);
    for (const Sample& sample : io::read_series(folder / "out/rate/shear/series.csv")) {
        EXPECT_EQ(sample.shear_rate, 0.5);
        EXPECT_NEAR(sample.time, sample.strain / 0.5, 1e-12);
    }
}

TEST_F(SmallRun, RunOutOfTimeIsUndecidedAndKeepsItsLastState)
{
    write("short.json",
          R"({"suspension": {"particles": 30, "volume_fraction": 0.4, "size_ratio": 1},
        "steps": [{"step": "pack"},
                  {"step": "shear", "stress": 2, "strain": 5, "maximum_time": 0.1}]})");
    const Said said = run("run short.json -q");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    EXPECT_EQ(json("out/short/summary.json")["steps"]["shear"]["outcome"], "undecided");
    EXPECT_NEAR(io::read_series(folder / "out/short/shear/series.csv").back().time, 0.1, 1e-12);
}

TEST_F(SmallRun, FlowCurveHoldsTheMeansOfItsRunsAndWhatJams)
{
    write("curve.json", R"({"suspension": {"particles": 50, "volume_fraction": 0.61},
        "steps": [{"step": "pack"},
                  {"step": "shear", "sweep": {"stress": [0.3, 0.6, 20]}, "strain": 0.3},
                  {"step": "flow_curve", "width": 640, "height": 360}]})");
    const Said said = run("run curve.json -q");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    const Json steps = json("out/curve/summary.json")["steps"];
    const Json curve = steps["flow_curve"]["curves"][0];
    EXPECT_EQ(curve["volume_fraction"], 0.61);
    EXPECT_EQ(curve["shape"], "arch-shaped");
    EXPECT_EQ(curve["jamming_stress"], 20);
    EXPECT_EQ(curve["slopes"].size(), 2u);
    EXPECT_EQ(curve["slopes"][1]["trend"], "falls");

    std::istringstream table(text_of(folder / "out/curve/flow_curve.csv"));
    std::string line;
    std::getline(table, line);
    std::getline(table, line);
    for (const char* stress : {"0.3", "0.6"}) {
        std::getline(table, line);
        const Json& means = steps["shear_" + std::string(stress)];
        std::istringstream cells(line);
        std::vector<std::string> cell(11);
        for (std::string& one : cell) std::getline(cells, one, ',');
        EXPECT_EQ(cell[1], "stress");
        EXPECT_EQ(cell[2], stress);
        EXPECT_EQ(cell[3], "0");
        EXPECT_DOUBLE_EQ(std::stod(cell[4]), means["shear_rate"]["mean"].get<double>());
        EXPECT_DOUBLE_EQ(std::stod(cell[5]), means["shear_rate"]["standard_error"].get<double>());
        EXPECT_NEAR(std::stod(cell[6]), means["viscosity"]["mean"].get<double>(), 1e-9);
        EXPECT_EQ(cell[9], "flowing");
    }
    std::getline(table, line);
    EXPECT_TRUE(line.starts_with("0.61,stress,20,0,0,0,,,")) << line;
    EXPECT_TRUE(line.ends_with(",jammed,shear_20")) << line;
    for (const char* name : {"flow_curve.png", "flow_curve.svg", "flow_curve_viscosity.png"})
        EXPECT_GT(std::filesystem::file_size(folder / "out/curve" / name), 1000u) << name;
}

TEST_F(SmallRun, StabilityFollowsFromTheFlowCurve)
{
    write("falls.json", R"({"suspension": {"particles": 100, "volume_fraction": 0.58},
        "steps": [{"step": "pack"},
                  {"step": "shear", "sweep": {"stress": [0.5, 1]}, "strain": 1},
                  {"step": "flow_curve", "width": 640, "height": 360},
                  {"step": "stability", "relaxation_strain": 0.05, "relaxation_strain_error": 0.01,
                   "width": 640, "height": 360}]})");
    const Said said = run("run falls.json -q");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    const Json steps = json("out/falls/summary.json")["steps"];
    const double slope = steps["flow_curve"]["curves"][0]["slopes"][0]["slope"].get<double>();
    ASSERT_LT(slope, 0);
    const Json worst = steps["stability"]["least_stable"][0];
    EXPECT_DOUBLE_EQ(worst["slope"]["mean"].get<double>(), slope);
    const double rate = (steps["shear_0.5"]["shear_rate"]["mean"].get<double>() +
                         steps["shear_1"]["shear_rate"]["mean"].get<double>()) /
                        2;
    const double pi = std::acos(-1), viscosity = 0.75 / rate;
    const double critical = worst["critical_reynolds"]["mean"].get<double>();
    EXPECT_NEAR(critical, -pi * pi * 0.05 / (viscosity * slope), 1e-9 * critical);
    EXPECT_GT(worst["critical_reynolds"]["standard_error"].get<double>(),
              0.2 * critical);  // that of c alone
    EXPECT_EQ(worst["growing_roots_at_twice_critical"]["by_polynomial"], 2);
    EXPECT_EQ(worst["growing_roots_at_twice_critical"]["by_argument_principle"], 2);
    for (const char* name : {"stability.csv", "stability.png", "stability_growth.svg",
                             "stability_map.csv", "stability_map.png"})
        EXPECT_GT(std::filesystem::file_size(folder / "out/falls" / name), 300u) << name;
}

TEST_F(SmallRun, WyartCatesFitsTheViscositiesOfAllVolumeFractions)
{
    write("fitted.json", R"({"suspension": {"particles": 40},
        "steps": [{"step": "pack", "volume_fraction": 0.45},
                  {"step": "shear", "name": "thin", "sweep": {"stress": [0.3, 3, 20]}, "strain": 0.3},
                  {"step": "pack", "name": "denser", "volume_fraction": 0.55},
                  {"step": "shear", "name": "thick", "sweep": {"stress": [0.3, 3, 20]}, "strain": 0.3},
                  {"step": "wyart_cates", "bootstrap_samples": 20, "width": 640, "height": 360}]})");
    const Said said = run("run fitted.json -q");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    const Json steps = json("out/fitted/summary.json")["steps"], fit = steps["wyart_cates"];
    const auto value = [&](const char* name) { return fit[name]["mean"].get<double>(); };
    // the model of the summary has the rms distance of the summary from the measured viscosities
    double sum = 0;
    int count = 0;
    for (const char* name : {"thin_0.3", "thin_3", "thin_20", "thick_0.3", "thick_3", "thick_20"}) {
        const Json& means = steps[name];
        if (means["outcome"] != "flowing") continue;
        const double phi = name[3] == 'n' ? 0.45 : 0.55;
        const double f =
            std::exp(-std::pow(value("onset_stress") / means["shear_stress"]["mean"].get<double>(),
                               value("sharpness")));
        const double jamming =
            f * value("frictional_fraction") + (1 - f) * value("frictionless_fraction");
        ASSERT_LT(phi, jamming) << name;
        const double viscosity =
            value("amplitude") * std::pow(1 - phi / jamming, -value("exponent"));
        sum += std::pow(std::log(viscosity / means["viscosity"]["mean"].get<double>()), 2);
        ++count;
    }
    EXPECT_NEAR(std::sqrt(sum / count), fit["rms"].get<double>(), 1e-9);
    EXPECT_EQ(fit["verdict"][0].get<std::string>().find("lowest Akaike") == std::string::npos,
              false);
    EXPECT_EQ(fit["shapes"].size(), 2u);
    for (const char* name : {"wyart_cates.csv", "wyart_cates.png", "wyart_cates_map.svg"})
        EXPECT_GT(std::filesystem::file_size(folder / "out/fitted" / name), 300u) << name;
}

TEST_F(SmallRun, OneDimensionalFlowGrowsAsTheLinearTheorySays)
{
    write("gap.json", R"({"suspension": {"particles": 100, "volume_fraction": 0.58},
        "steps": [{"step": "pack"},
                  {"step": "shear", "sweep": {"stress": [0.5, 1, 2]}, "strain": 1},
                  {"step": "one_dimensional_flow", "cells": 8, "disturbance": 1e-4, "width": 640,
                   "height": 360},
                  {"step": "one_dimensional_flow", "name": "measured", "cells": 8,
                   "relaxation_strains": [0.02, 0.002], "weights": [0.3, 0.7],
                   "instantaneous_viscosity": 9.5, "reynolds_over_critical": 0.7,
                   "disturbance": 1e-4, "width": 640, "height": 360}]})");
    const Said said = run("run gap.json -q");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    const Json steps = json("out/gap/summary.json")["steps"];
    for (const char* name : {"one_dimensional_flow", "measured"}) {
        const Json step = steps[name];
        EXPECT_EQ(step["agrees"], true) << step;
        const bool unstable = std::string(name) != "measured";
        EXPECT_EQ(step["integrated"]["growth"].get<double>() > 0, unstable);
        EXPECT_EQ(step["outcome"].get<std::string>().substr(0, 8),
                  unstable ? "unstable" : "stable, ");
        EXPECT_NEAR(step["reynolds"].get<double>() / step["critical_reynolds"].get<double>(),
                    unstable ? 2 : 0.7, 1e-12);
        const std::string base = "out/gap/" + std::string(name);
        for (const char* end :
             {".csv", "_field.csv", ".png", "_growth.png", "_profiles.png", ".svg"})
            EXPECT_GT(std::filesystem::file_size(folder / (base + end)), 1000u) << name << end;
    }
}

TEST_F(SmallRun, NoPictureIsDrawnOfWhatHasNoPoints)
{
    write("all_jam.json", R"({"suspension": {"particles": 50, "volume_fraction": 0.61},
        "steps": [{"step": "pack"},
                  {"step": "shear", "sweep": {"stress": [40, 80]}, "strain": 0.5},
                  {"step": "pack", "name": "denser", "volume_fraction": 0.605},
                  {"step": "shear", "name": "denser_shear", "sweep": {"stress": [40, 80]}, "strain": 0.5},
                  {"step": "flow_curve"}, {"step": "stability"}, {"step": "wyart_cates"},
                  {"step": "one_dimensional_flow"},
                  {"step": "one_dimensional_flow", "name": "asked", "stress": 1, "reynolds": 1}]})");
    const Said said = run("run all_jam.json -q");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    const Json steps = json("out/all_jam/summary.json")["steps"];
    ASSERT_EQ(steps["shear_40"]["outcome"], "jammed");
    EXPECT_EQ(steps["flow_curve"]["curves"][0]["shape"], "arch-shaped");
    EXPECT_EQ(steps["flow_curve"]["outcome"], "no picture, nothing flows");
    EXPECT_EQ(steps["stability"]["outcome"], "nothing to say, no two neighbouring stresses flow");
    EXPECT_EQ(steps["wyart_cates"]["outcome"],
              "nothing fitted: 4 parameters need at least 5 flowing points, there are 0");
    for (const char* name : {"one_dimensional_flow", "asked"})
        EXPECT_EQ(steps[name]["outcome"].get<std::string>().substr(0, 14), "not integrated");
    for (const char* name :
         {"flow_curve", "flow_curve_viscosity", "stability", "wyart_cates", "wyart_cates_map"})
        EXPECT_FALSE(
            std::filesystem::exists(folder / "out/all_jam" / (name + std::string(".png"))));
    EXPECT_TRUE(std::filesystem::exists(folder / "out/all_jam/flow_curve.csv"));
}

TEST_F(SmallRun, FlowCurveShowsImposedRatesBesideImposedStresses)
{
    write("both.json", R"({"suspension": {"particles": 30, "volume_fraction": 0.4, "size_ratio": 1,
                                          "model": {"stiffness_scale": "fixed"}},
        "steps": [{"step": "pack"},
                  {"step": "shear", "sweep": {"stress": [1, 2]}, "strain": 0.2},
                  {"step": "shear", "name": "rate", "sweep": {"rate": [0.2, 0.1]}, "strain": 0.2},
                  {"step": "flow_curve", "width": 640, "height": 360}]})");
    const Said said = run("run both.json -q");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    const std::string table = text_of(folder / "out/both/flow_curve.csv");
    EXPECT_NE(table.find("\n0.4,rate,"), std::string::npos) << table;
    EXPECT_NE(table.find(",0.1,0,"), std::string::npos) << table;  // exactly what was imposed
    EXPECT_LT(table.find("rate_0.1\n"), table.find("rate_0.2\n"));
    EXPECT_NE(text_of(folder / "out/both/flow_curve_viscosity.svg").find("imposed rate"),
              std::string::npos);
    const Json curves = json("out/both/summary.json")["steps"]["flow_curve"]["curves"];
    ASSERT_EQ(curves.size(), 1u);
    EXPECT_EQ(curves[0]["slopes"].size(), 1u);
}

TEST_F(SmallRun, JammedSuspensionIsAResult)
{
    write("jam.json", R"({"suspension": {"particles": 50, "volume_fraction": 0.61},
        "steps": [{"step": "pack"}, {"step": "shear", "stress": 20, "strain": 2},
                  {"step": "velocity_profile"}, {"step": "plot", "width": 640, "height": 360},
                  {"step": "panels", "of": ["velocity_profile", "plot"], "width": 640},
                  {"step": "panels", "of": ["velocity_profile"]}]})");
    const Said said = run("run jam.json -q");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    const Json shear = json("out/jam/summary.json")["steps"]["shear"];
    EXPECT_EQ(shear["outcome"], "jammed");
    // the profile has no picture, so there is none of both
    const Json figure = json("out/jam/summary.json")["steps"]["panels"];
    EXPECT_EQ(figure["without"], Json::array({"velocity_profile"}));
    EXPECT_TRUE(std::filesystem::exists(folder / "out/jam/panels.png"));
    const Json none = json("out/jam/summary.json")["steps"]["panels_2"];
    EXPECT_EQ(none["outcome"], "no picture, none of these steps has drawn one");
    EXPECT_FALSE(std::filesystem::exists(folder / "out/jam/panels_2.png"));
    EXPECT_LT(shear["strain"].get<double>(), 0.5);
    EXPECT_LT(shear["jamming_window"]["strain_gain"].get<double>(), 1e-3);
    EXPECT_LT(shear["jamming_window"]["force_residual"].get<double>(), 0.01);
    EXPECT_FALSE(shear.contains("viscosity"));
    // springs and repulsion carry all of the stress
    const Sample last = io::read_series(folder / "out/jam/shear/series.csv").back();
    EXPECT_NEAR(last.stress_contact + last.stress_repulsion, 20, 0.02);
}

}
