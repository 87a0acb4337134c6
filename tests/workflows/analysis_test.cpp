// The steps that analyse stored frames, through the program; their numbers are found again from
// run.h5 by plain loops.
#include "engine/statistics.h"
#include "io/run_file.h"
#include "tests/workflows/program.h"

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::json;

class Analysis : public Program {
protected:
    Json steps(const std::string& name)
    {
        return Json::parse(text_of(folder / "out" / name / "summary.json"))["steps"];
    }

    /// Rows of a table as maps from the names of the columns.
    std::vector<std::map<std::string, double>> table(const std::string& path)
    {
        std::istringstream in(text_of(folder / "out" / path));
        std::string line, cell;
        std::getline(in, line);
        EXPECT_TRUE(line.starts_with("# ")) << path;
        std::getline(in, line);
        std::vector<std::string> names;
        for (std::istringstream head(line); std::getline(head, cell, ',');) names.push_back(cell);
        std::vector<std::map<std::string, double>> rows;
        while (std::getline(in, line)) {
            std::istringstream cells(line);
            rows.emplace_back();
            for (const std::string& name : names)
                if (std::getline(cells, cell, ',') && !cell.empty())
                    rows.back()[name] = std::stod(cell);
        }
        return rows;
    }

    bool exists(const std::string& path)
    {
        const auto file = folder / "out" / path;
        return std::filesystem::exists(file) && std::filesystem::file_size(file) > 100;
    }
};

void expect_estimate(const Json& found, const std::vector<double>& series)
{
    const Estimate expected = estimate_mean(series);
    EXPECT_NEAR(found["mean"].get<double>(), expected.mean, 1e-9 * (1 + std::abs(expected.mean)));
    EXPECT_NEAR(found["standard_error"].get<double>(), expected.standard_error,
                1e-9 * (1 + std::abs(expected.mean)));
}

/// All distances below half the box, over 3 x 3 x 3 images around the box in which everything lies.
template <class Visit>
void each_image(const State& s, double reach, const Visit& visit)
{
    for (int i = 0; i < s.size(); ++i)
        for (int j = 0; j < s.size(); ++j)
            for (int x = -2; x <= 2; ++x)
                for (int y = -1; y <= 1; ++y)
                    for (int z = -1; z <= 1; ++z) {
                        const Vec3 d = s.position[j] - s.position[i] +
                                       Vec3(x * s.box.length.x() + y * s.box.offset,
                                            y * s.box.length.y(), z * s.box.length.z());
                        if (i != j && d.norm() < reach) visit(i, j, d);
                    }
}

}

TEST_F(Analysis, NumbersAreThoseOfTheStoredFrames)
{
    write("flow.json", R"({"suspension": {"particles": 40, "volume_fraction": 0.5, "seed": 3},
        "steps": [{"step": "pack"},
                  {"step": "shear", "stress": 2, "strain": 1, "frame_interval": 0.05},
                  {"step": "contacts", "from_strain": 0.2, "width": 640, "height": 360},
                  {"step": "structure", "from_strain": 0.2, "width": 640, "height": 360},
                  {"step": "nonaffine", "from_strain": 0.2, "width": 640, "height": 360}]})");
    const Said said = run("run flow.json -q");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    const Json found = steps("flow");
    std::vector<Frame> frames = io::read_run(folder / "out/flow/shear/run.h5").frames;
    std::erase_if(frames, [](const Frame& f) { return f.state.strain < 0.2 - 1e-9; });
    ASSERT_EQ(frames.size(), 17u);
    EXPECT_EQ(found["contacts"]["frames"], 17);

    const int n = 40;
    const double reach = found["structure"]["largest_distance"].get<double>();
    const Vec3& length = frames[0].state.box.length;
    EXPECT_NEAR(reach, length.minCoeff() / 2, 1e-12);
    std::vector<double> contacts, sliding, force, close, neighbours, anisotropy, pairs, square,
        rate;
    std::vector<double> shear_fabric;
    double together = 0, pairs_at_contact = 0;
    for (const Frame& f : frames) {
        double slide = 0, sum = 0, xy = 0;
        for (const ContactForce& c : f.contacts) {
            slide += c.sliding;
            sum += c.normal_force;
            const Vec3 d = c.end - c.start;
            xy += d.x() * d.y() / d.squaredNorm();
        }
        const double count = static_cast<double>(f.contacts.size());
        contacts.push_back(2 * count / n);
        sliding.push_back(count > 0 ? slide / count : 0);
        force.push_back(count > 0 ? sum / count : 0);
        if (count > 0) shear_fabric.push_back(xy / count);
        double near = 0, compression = 0, extension = 0, all = 0, near_gap = 0;
        each_image(f.state, reach, [&](int i, int j, const Vec3& d) {
            const double surface = f.state.radius[i] + f.state.radius[j];
            all += 0.5;
            near_gap += d.norm() - surface < 0.1 ? 0.5 : 0;
            if (d.norm() >= surface * 1.05) return;
            near += 0.5;
            (d.x() * d.y() < 0 ? compression : extension) += 0.5;
        });
        close.push_back(count / near_gap);
        neighbours.push_back(2 * near / n);
        anisotropy.push_back((compression - extension) / near);
        pairs.push_back(all);
        double v2 = 0;
        for (const Vec3& v : f.nonaffine_velocity) v2 += v.squaredNorm() / n;
        square.push_back(v2);
        rate.push_back(f.sample.shear_rate);
        // all pairs: sum over i != j of V_i . V_j
        each_image(f.state, reach, [&](int i, int j, const Vec3&) {
            together += f.nonaffine_velocity[i].dot(f.nonaffine_velocity[j]) / v2 / 2;
        });
        pairs_at_contact += all;
    }
    expect_estimate(found["contacts"]["contact_number"], contacts);
    expect_estimate(found["contacts"]["sliding_fraction"], sliding);
    expect_estimate(found["contacts"]["mean_normal_force"], force);
    expect_estimate(found["contacts"]["frictional_pair_fraction"], close);
    EXPECT_NEAR(found["contacts"]["fabric"]["all"]["tensor"][0][1].get<double>(),
                estimate_mean(shear_fabric).mean, 1e-12);
    expect_estimate(found["structure"]["near_neighbours"], neighbours);
    expect_estimate(found["structure"]["quadrant_anisotropy"], anisotropy);

    // the integral of g(r) is the number of pairs
    double integral = 0;
    const auto g = table("flow/structure.csv");
    const double width = reach / static_cast<double>(g.size());
    for (const auto& row : g)
        integral += row.at("all") * 4 * std::numbers::pi *
                    (row.at("r") * row.at("r") + width * width / 12) * width;
    EXPECT_NEAR(integral * n * (n - 1) / 2 / length.prod(), estimate_mean(pairs).mean, 1e-6);

    const double mean_rate = estimate_mean(rate).mean, mean_square = estimate_mean(square).mean;
    EXPECT_NEAR(found["nonaffine"]["mean_square"]["mean"].get<double>(),
                mean_square / mean_rate / mean_rate, 1e-6 * mean_square / mean_rate / mean_rate);
    EXPECT_NEAR(found["nonaffine"]["viscosity"]["mean"].get<double>(), 2 / mean_rate,
                1e-6 / mean_rate);
    // bins weighted by their pairs, where all frames have the same weight in a bin nearly
    double weighted = 0, counted = 0;
    for (const auto& row : table("flow/nonaffine.csv")) {
        counted += row.at("all_pairs");
        if (row.contains("all")) weighted += row.at("all") * row.at("all_pairs");
    }
    EXPECT_NEAR(counted, pairs_at_contact, 1e-9);
    EXPECT_NEAR(weighted / counted, together / counted, 0.02);

    for (const char* name :
         {"contacts.png", "contacts.svg", "contacts_forces.png", "contacts_forces.csv",
          "contacts_per_particle.csv", "structure.png", "structure_angles.svg", "structure_map.png",
          "structure_map.csv", "nonaffine.png", "nonaffine_velocity.png", "nonaffine_velocity.csv"})
        EXPECT_TRUE(exists(std::string("flow/") + name)) << name;
}

TEST_F(Analysis, JammedSuspensionHasAContactNetworkButNoErrorsAndNoField)
{
    write("jam.json", R"({"suspension": {"particles": 50, "volume_fraction": 0.61},
        "steps": [{"step": "pack"}, {"step": "shear", "stress": 20, "strain": 2},
                  {"step": "contacts", "width": 640, "height": 360},
                  {"step": "structure", "width": 640, "height": 360},
                  {"step": "nonaffine"}]})");
    const Said said = run("run jam.json -q");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    const Json found = steps("jam");
    ASSERT_EQ(found["shear"]["outcome"], "jammed");
    for (const char* step : {"contacts", "structure"}) {
        EXPECT_EQ(found[step]["outcome"], "jammed, the last frame only, no errors");
        EXPECT_EQ(found[step]["frames"], 1);
    }
    const Json& z = found["contacts"]["net_contact_number"];
    EXPECT_GE(z["mean"].get<double>(), 4);  // enough to be rigid with friction
    EXPECT_TRUE(z["standard_error"].is_null());
    EXPECT_EQ(found["contacts"]["percolates_gradient"]["mean"], 1);
    EXPECT_EQ(found["nonaffine"]["outcome"], "no field, the suspension is jammed");
    EXPECT_TRUE(exists("jam/structure_map.png"));
    EXPECT_FALSE(exists("jam/nonaffine.png"));
}

TEST_F(Analysis, WithoutContactsAndFramesThereAreWordsInsteadOfPictures)
{
    write("thin.json", R"({"suspension": {"particles": 30, "volume_fraction": 0.05},
        "steps": [{"step": "pack"},
                  {"step": "shear", "stress": 0.1, "strain": 0.01, "frame_interval": 1},
                  {"step": "contacts", "from_strain": 0.01, "width": 640, "height": 360},
                  {"step": "structure", "from_strain": 0.01, "width": 640, "height": 360},
                  {"step": "nonaffine", "from_strain": 0.01, "width": 640, "height": 360},
                  {"step": "shear", "name": "short", "stress": 0.1, "strain": 5,
                   "maximum_time": 0.1},
                  {"step": "contacts", "name": "nothing", "from_strain": 5},
                  {"step": "structure", "name": "nowhere", "from_strain": 5},
                  {"step": "nonaffine", "name": "nobody", "from_strain": 5}]})");
    const Said said = run("run thin.json -q");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    const Json found = steps("thin");
    EXPECT_EQ(found["contacts"]["outcome"], "one frame only, no errors");
    EXPECT_EQ(found["contacts"]["forces"], "no contacts, no distribution of forces");
    EXPECT_EQ(found["contacts"]["contact_number"]["mean"], 0);
    EXPECT_FALSE(found["contacts"].contains("fabric"));
    EXPECT_TRUE(exists("thin/contacts.png"));
    EXPECT_FALSE(exists("thin/contacts_forces.png"));
    EXPECT_TRUE(exists("thin/structure.png"));
    EXPECT_TRUE(found["nonaffine"].contains("mean_square"));
    for (const char* step : {"nothing", "nowhere", "nobody"}) {
        EXPECT_EQ(found[step]["outcome"], "no frames, the run ended before from_strain");
        EXPECT_FALSE(exists("thin/" + std::string(step) + ".png"));
    }
}

TEST_F(Analysis, DistancesBeyondHalfTheBoxAreRefusedWithTheirPlace)
{
    const auto refused = [&](const std::string& step) {
        write("wrong.json", R"({"suspension": {"particles": 40, "volume_fraction": 0.5},
 "steps": [{"step": "pack"}, {"step": "shear", "stress": 2, "strain": 1},
)" + step + "]}");
        const Said said = run("validate wrong.json");
        EXPECT_EQ(said.exit_code, 65) << step;
        return said.err + said.out;
    };
    for (const std::string step : {"structure", "nonaffine"}) {
        const std::string text = refused(R"({"step": ")" + step + R"(", "distance": 6})");
        EXPECT_NE(text.find("wrong.json:3:"), std::string::npos) << text;
        EXPECT_NE(text.find("/steps/2/distance: must be <= "), std::string::npos) << text;
        EXPECT_NE(text.find("half the smallest box length"), std::string::npos) << text;
    }
    EXPECT_NE(refused(R"({"step": "contacts", "from_strain": 2})").find("must be <= 1"),
              std::string::npos);
    EXPECT_NE(refused(R"({"step": "structure", "near_xi": 2})").find("needs a larger box"),
              std::string::npos);
}

}
