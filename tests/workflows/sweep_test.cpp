// Sweeps: the points, what is refused, failures, kills, the table.
#include "workflows/sweep.h"

#include "tests/support/sanitized.h"
#include "tests/workflows/program.h"
#include "workflows/slurm.h"

#include <signal.h>
#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

std::vector<std::string> texts(const Swept& swept)
{
    std::vector<std::string> result;
    for (const Json& value : swept.values) result.push_back(value_text(value));
    return result;
}

std::vector<std::string> values(const std::string& option)
{
    return texts(parse_swept("/a=" + option));
}

using Words = std::vector<std::string>;

std::string usage_error(const std::string& option)
{
    try {
        parse_swept(option);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::usage);
        return error.what();
    }
    return "accepted";
}

std::vector<std::string> names_of(const std::vector<std::string>& options, int repeats = 1)
{
    Sweep sweep{.settings = {}, .swept = {}, .repeats = repeats};
    for (const std::string& option : options) sweep.swept.push_back(parse_swept(option));
    std::vector<std::string> names;
    for (const Point& point : points_of(sweep, [](const Point&) { return std::uint64_t{5}; }))
        names.push_back(point.name);
    return names;
}

}

TEST(SweptValues, AreListsOfJsonValuesOrWords)
{
    EXPECT_EQ(values("0.50,1,2e0"), (Words{"0.5", "1", "2"}));
    EXPECT_EQ(values("heun,euler"), (Words{"heun", "euler"}));
    EXPECT_EQ(values("[1,2],[2,1]"), (Words{"[1,2]", "[2,1]"}));
    EXPECT_EQ(values(R"("a,b",true,{"x":[1,2]})"), (Words{"a,b", "true", R"({"x":[1,2]})"}));
    EXPECT_EQ(values("/data/a:b.h5"), (Words{"/data/a:b.h5"}));
}

TEST(SweptValues, OfRangesHaveEqualStepsOrRatiosAndBothEnds)
{
    EXPECT_EQ(values("0.54:0.58:5"), (Words{"0.54", "0.55", "0.56", "0.57", "0.58"}));
    EXPECT_EQ(values("1:-1:3"), (Words{"1", "0", "-1"}));
    EXPECT_EQ(values("0.01:100:5:log"), (Words{"0.01", "0.1", "1", "10", "100"}));
}

TEST(SweptValues, OfAnotherFormAreRefused)
{
    EXPECT_NE(usage_error("stress=1").find("must be a JSON pointer and a value"),
              std::string::npos);
    EXPECT_NE(usage_error("/a").find("must be a JSON pointer"), std::string::npos);
    EXPECT_NE(usage_error("").find("must be a JSON pointer"), std::string::npos);
    EXPECT_NE(usage_error("/a=1,,2").find("must not have empty values"), std::string::npos);
    EXPECT_NE(usage_error("/a=1,2,1.0").find("has the value 1 twice"), std::string::npos);
    EXPECT_NE(usage_error("/a=1:2:1").find("must have 2 to"), std::string::npos);
    EXPECT_NE(usage_error("/a=0:2:3:log").find("must have ends > 0"), std::string::npos);
}

TEST(SweepPoints, AreAllCombinationsTheLastParameterChangesFastest)
{
    EXPECT_EQ(names_of({"/suspension/volume_fraction=0.54,0.56", "/steps/2/stress=1,2"}),
              (Words{"stress_1_volume_fraction_0.54", "stress_2_volume_fraction_0.54",
                     "stress_1_volume_fraction_0.56", "stress_2_volume_fraction_0.56"}));
    EXPECT_EQ(names_of({"/steps/1/stress=1", "/steps/2/stress=2"}),
              (Words{"steps_1_stress_1_steps_2_stress_2"}));
    EXPECT_EQ(names_of({"/steps/1/stress=1"}, 3),
              (Words{"stress_1", "stress_1_repeat_2", "stress_1_repeat_3"}));
}

TEST(SweepPoints, HaveNamesThatAreSafeDifferentAndThoseOfTheirValuesAlone)
{
    const Words files = names_of({R"(/steps/0/file=a/run.h5,b/run.h5,"../x y",;rm)"});
    EXPECT_EQ(std::set<std::string>(files.begin(), files.end()).size(), files.size());
    for (const std::string& name : files) {
        EXPECT_EQ(name.find_first_of("/ ;'\"\n"), std::string::npos) << name;
        EXPECT_TRUE(name.starts_with("file_")) << name;
    }
    EXPECT_EQ(names_of({R"(/steps/0/file=;rm)"}).front(), files.back());
    EXPECT_EQ(names_of({"/a=1", "/b=2"}), names_of({"/b=2", "/a=1"}));
}

TEST(SlurmStates, AreReadAsSlurmPrintsThem)
{
    using States = std::vector<std::pair<std::string, std::string>>;
    EXPECT_EQ(slurm_states("7_1 RUNNING\n7_2 PENDING\n"),
              (States{{"7_1", "RUNNING"}, {"7_2", "PENDING"}}));
    EXPECT_EQ(slurm_states("7_1|CANCELLED by 0\n"), (States{{"7_1", "CANCELLED by 0"}}));
    EXPECT_EQ(slurm_job_states("JobId=9 ArrayJobId=7 ArrayTaskId=3 JobName=a UserId=root(0) "
                               "JobState=FAILED Reason=NonZeroExitCode Dependency=(null)\n"
                               "JobId=7 ArrayJobId=7 ArrayTaskId=4-8 JobName=a JobState=PENDING\n"),
              (States{{"7_3", "FAILED"}}));
}

namespace {

class SweepOfRuns : public Program {
protected:
    void SetUp() override
    {
        Program::SetUp();
        write_flow("0.3");
    }

    void write_flow(const std::string& strain)
    {
        write("w.json", R"({"suspension": {"particles": 30, "volume_fraction": 0.45, "seed": 9},
            "steps": [{"step": "pack"}, {"step": "shear", "stress": 2, "strain": )" +
                            strain + "}]}");
    }

    /// All files of all points, without what says when and how long.
    std::map<std::string, std::string> results(const std::string& sweep)
    {
        std::map<std::string, std::string> files;
        const fs::path points = folder / sweep / "points";
        for (const auto& entry : fs::recursive_directory_iterator(points))
            if (entry.is_regular_file() && entry.path().filename() != "manifest.json" &&
                entry.path().extension() != ".log" &&
                entry.path().parent_path().filename() != ".sigmaflow")
                files[fs::relative(entry.path(), points).string()] = text_of(entry.path());
        return files;
    }

    Json summary(const std::string& point)
    {
        return Json::parse(text_of(folder / point / "summary.json"))["steps"];
    }

    /// Rows of a table by column; no field of it has commas or quotes.
    std::vector<std::map<std::string, std::string>> table(const std::string& name)
    {
        std::istringstream lines(text_of(folder / name));
        std::vector<std::map<std::string, std::string>> rows;
        std::vector<std::string> columns;
        for (std::string line; std::getline(lines, line);) {
            if (line.starts_with("#")) continue;
            std::istringstream fields(line + ",");
            std::vector<std::string> row;
            for (std::string field; std::getline(fields, field, ',');) row.push_back(field);
            if (columns.empty()) {
                columns = row;
                continue;
            }
            EXPECT_EQ(row.size(), columns.size()) << line;
            auto& cells = rows.emplace_back();
            for (std::size_t k = 0; k < std::min(row.size(), columns.size()); ++k)
                cells[columns[k]] = row[k];
        }
        return rows;
    }

    void expect_in(const std::string& text, const std::string& words)
    {
        EXPECT_NE(text.find(words), std::string::npos) << words << " is not in\n" << text;
    }

    /// The program in a process of its own.
    pid_t start(const std::vector<std::string>& arguments)
    {
        std::vector<std::string> words = arguments;
        words.insert(words.begin(), SIGMAFLOW_PROGRAM);
        std::vector<char*> pointers;
        for (std::string& word : words) pointers.push_back(word.data());
        pointers.push_back(nullptr);
        const pid_t child = fork();
        if (child == 0) {
            if (chdir(folder.c_str()) == 0) execv(pointers[0], pointers.data());
            _exit(127);
        }
        return child;
    }

    bool comes(const std::function<bool()>& condition)
    {
        for (int k = 0; k < 3000; ++k) {
            if (condition()) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        return false;
    }
};

}

TEST_F(SweepOfRuns, HasTheBytesOfSingleRunsAndTheNumbersOfTheirSummaries)
{
    const Said said =
        run("sweep w.json --sweep /steps/1/stress=1,2 --sweep /suspension/volume_fraction=0.4,0.45 "
            "--out s -q");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    EXPECT_EQ(said.err, "");
    expect_in(said.out, "4 complete");
    ASSERT_EQ(run("run w.json --set /steps/1/stress=1 -q --out points/one").exit_code, 0);
    for (const char* file : {"summary.json", "shear/series.csv"})
        EXPECT_EQ(text_of(folder / "points/one" / file),
                  text_of(folder / "s/points/stress_1_volume_fraction_0.45" / file));

    const auto rows = table("s/table.csv");
    ASSERT_EQ(rows.size(), 4u);
    for (const auto& row : rows) {
        const Json shear = summary("s/points/" + row.at("point"))["shear"];
        EXPECT_EQ(row.at("point"),
                  "stress_" + row.at("stress") + "_volume_fraction_" + row.at("volume_fraction"));
        EXPECT_EQ(row.at("status"), "complete");
        EXPECT_EQ(row.at("outcome"), shear["outcome"].get<std::string>());
        for (const char* quantity : {"shear_rate", "viscosity", "contact_number"})
            for (const char* part : {"mean", "standard_error"})
                EXPECT_EQ(std::stod(row.at(std::string("shear.") + quantity + "." + part)),
                          shear[quantity][part].get<double>());
    }
    for (const char* figure : {"shear_viscosity.png", "shear_viscosity.svg"})
        EXPECT_GT(fs::file_size(folder / "s" / figure), 1000u);
    ASSERT_EQ(run("collect s --y shear.contact_number").exit_code, 0);
    EXPECT_TRUE(fs::exists(folder / "s/shear_contact_number.png"));
    const Said misspelt = run("collect s --y shear.viscosit");
    EXPECT_EQ(misspelt.exit_code, 64);
    expect_in(misspelt.err, "did you mean \"shear.viscosity.mean\"?");
}

TEST_F(SweepOfRuns, IsRefusedAsAWholeBeforeAnythingRuns)
{
    const Said said =
        run("sweep w.json --sweep /steps/1/stress=1,-2 --sweep /suspension/volume_fraction=0.4,0.9 "
            "--out s");
    EXPECT_EQ(said.exit_code, 65);
    expect_in(said.err, "point stress_-2_volume_fraction_0.4: ");
    expect_in(said.err, "/steps/1/stress: must be ");
    expect_in(said.err, "got -2");
    expect_in(said.err, "point stress_1_volume_fraction_0.9: ");
    expect_in(said.err, "must be <= 0.6528");
    EXPECT_FALSE(fs::exists(folder / "s"));
    const std::pair<const char*, int> wrong[] = {
        {"sweep w.json --out s", 64},
        {"sweep w.json --out s --sweep /steps/1/stress", 64},
        {"sweep w.json --out s --sweep /steps/1/stress=1 --sweep /steps/1/stress=2", 64},
        {"sweep w.json --out s --sweep /steps/1/stress=1 --set /steps/1/stress=2", 64},
        {"sweep w.json --out s --sweep /suspension/seed=1,2 --repeat 2", 64},
        {"sweep w.json --out s --sweep /steps/1/stres=1", 65},
        {"sweep w.json --out s --sweep /steps/7/stress=1", 65},
        {"sweep w.json --out s --sweep /steps/1/stress=1 --no-submit", 64},
        {"sweep none.json --out s --sweep /steps/1/stress=1", 66},
        {"collect none", 66},
        {"collect .", 65}};
    for (const auto& [arguments, code] : wrong)
        EXPECT_EQ(run(arguments).exit_code, code) << arguments;
    EXPECT_FALSE(fs::exists(folder / "s"));
    fs::create_directories(folder / "mine");
    write("mine/thesis.txt", "precious");
    EXPECT_EQ(run("sweep w.json --sweep /steps/1/stress=1 --out mine").exit_code, 73);
}

TEST_F(SweepOfRuns, OnePointThatFailsStopsNoOther)
{
    const std::string command = "sweep w.json --sweep /steps/1/stress=1,2,4 --out s --jobs 1";
    ASSERT_EQ(run(command + " --engine slurm --no-submit").exit_code, 0);
    fs::create_directories(folder / "s/points/stress_2");
    write("s/points/stress_2/notes.txt", "mine");
    const Said said = run(command);
    EXPECT_EQ(said.exit_code, 73);
    expect_in(said.err, "1 of 3 points failed");
    expect_in(said.err, "stress_2: exit code 73, points/stress_2: is not empty");
    expect_in(said.out, "2 complete, 1 failed");
    const auto rows = table("s/table.csv");
    ASSERT_EQ(rows.size(), 3u);
    EXPECT_EQ(rows[0].at("status") + rows[2].at("status"), "completecomplete");
    EXPECT_EQ(rows[1].at("status"), "failed");
    EXPECT_EQ(rows[1].at("exit_code"), "73");
    EXPECT_NE(rows[1].at("message").find("holds no earlier run"), std::string::npos);
    fs::remove(folder / "s/points/stress_2/notes.txt");
    const Said again = run("sweep s");
    EXPECT_EQ(again.exit_code, 0) << again.err;
    expect_in(again.err, "2 of an earlier run");
    EXPECT_EQ(table("s/table.csv")[1].at("status"), "complete");
}

TEST_F(SweepOfRuns, TakesMoreValuesButNoOtherParameters)
{
    const auto sweep = [&](const std::string& more) { return run("sweep w.json --out s " + more); };
    ASSERT_EQ(sweep("--sweep /steps/1/stress=1,2").exit_code, 0);
    const auto before = fs::last_write_time(folder / "s/points/stress_1/summary.json");
    const Said fewer = sweep("--sweep /steps/1/stress=1");
    EXPECT_EQ(fewer.exit_code, 65);
    expect_in(fewer.err, "/steps/1/stress was 1, 2, is 1 (values can be added, not left out)");
    const Said other = sweep("--sweep /suspension/volume_fraction=0.4");
    EXPECT_EQ(other.exit_code, 65);
    expect_in(other.err, "--sweep was /steps/1/stress, is /suspension/volume_fraction");
    const Said set = sweep("--sweep /steps/1/stress=1,2 --set /steps/1/strain=0.4");
    EXPECT_EQ(set.exit_code, 65);
    expect_in(set.err, "--set was nothing, is /steps/1/strain=0.4");

    const Said more = sweep("--sweep /steps/1/stress=4,1,2");
    EXPECT_EQ(more.exit_code, 0) << more.err;
    expect_in(more.err, "2 of an earlier run");
    EXPECT_EQ(run("sweep s --sweep /steps/1/stress=8").exit_code, 0);
    EXPECT_EQ(table("s/table.csv").size(), 4u);
    EXPECT_EQ(fs::last_write_time(folder / "s/points/stress_1/summary.json"), before);

    write_flow("0.4");  // the sweep keeps the workflow that it began with
    const Said changed = sweep("--sweep /steps/1/stress=1,2,4,8");
    EXPECT_EQ(changed.exit_code, 65);
    expect_in(changed.err, "/steps/1/strain of the workflow was 0.3, is 0.4");
    EXPECT_EQ(run("sweep s").exit_code, 0);
}

TEST_F(SweepOfRuns, FindsFilesOfTheWorkflowFromItsOwnFolder)
{
    ASSERT_EQ(run("run w.json -q --out data").exit_code, 0);
    write("again.json", R"({"steps": [{"step": "stored_run", "file": "data/shear/run.h5"},
                                       {"step": "velocity_profile", "bins": 4}]})");
    const Said said = run("sweep again.json --sweep /steps/1/bins=3,5 --out deep/down -q");
    EXPECT_EQ(said.exit_code, 0) << said.err;
    const Said set =
        run("sweep again.json --sweep /steps/1/bins=3 --set /steps/0/file=./data/shear/run.h5 "
            "--out u -q");
    EXPECT_EQ(set.exit_code, 0) << set.err;
    const Said files =
        run("sweep again.json --sweep /steps/0/file=data/shear/run.h5,data/shear/none.h5 --out t");
    EXPECT_EQ(files.exit_code, 65);
    expect_in(files.err, "must be a file");
}

TEST_F(SweepOfRuns, RepeatsHaveSeedsOfTheirOwnAndErrorsFromTheirScatter)
{
    const Said said = run("sweep w.json --sweep /steps/1/stress=1,2 --repeat 3 --out s -q");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    const auto rows = table("s/table.csv"), runs = table("s/runs.csv");
    ASSERT_EQ(rows.size(), 2u);
    ASSERT_EQ(runs.size(), 6u);
    for (const std::string stress : {"1", "2"}) {
        std::set<std::uint64_t> seeds;
        std::vector<double> rates;
        for (const char* repeat : {"", "_repeat_2", "_repeat_3"}) {
            const Json steps = summary("s/points/stress_" + stress + repeat);
            seeds.insert(steps["pack"]["seed"].get<std::uint64_t>());
            rates.push_back(steps["shear"]["shear_rate"]["mean"].get<double>());
        }
        EXPECT_EQ(seeds.size(), 3u);
        EXPECT_TRUE(seeds.contains(9));  // of the workflow
        const double mean = (rates[0] + rates[1] + rates[2]) / 3;
        double variance = 0;
        for (const double rate : rates) variance += (rate - mean) * (rate - mean) / 2;
        const auto& row = stress == "1" ? rows[0] : rows[1];
        EXPECT_EQ(row.at("repeats"), "3");
        EXPECT_NEAR(std::stod(row.at("shear.shear_rate.mean")), mean, 1e-14 * mean);
        EXPECT_NEAR(std::stod(row.at("shear.shear_rate.standard_error")), std::sqrt(variance / 3),
                    1e-10 * mean);
    }
    const Said more = run("sweep s --repeat 4");
    EXPECT_EQ(more.exit_code, 0) << more.err;
    expect_in(more.err, "6 of an earlier run");
    EXPECT_EQ(run("sweep s --repeat 2").exit_code, 65);
}

TEST_F(SweepOfRuns, KilledOrStoppedGoesOnToTheSameBytes)
{
    write_flow("6");
    const std::string options = "--sweep /steps/1/stress=1,2,4 --checkpoint-interval 0.05 -q";
    ASSERT_EQ(run("sweep w.json --out whole " + options).exit_code, 0);
    for (const int sent : {SIGKILL, SIGTERM}) {
        const std::string name = "after_" + std::to_string(sent);
        const pid_t sweep =
            start({"sweep", "w.json", "--out", name, "--sweep", "/steps/1/stress=1,2,4",
                   "--checkpoint-interval", "0.05", "--jobs", "2", "-q"});
        EXPECT_TRUE(comes([&] {
            return fs::exists(folder / name / "points/stress_1/shear/series.csv") &&
                   fs::exists(folder / name / "points/stress_2/shear/series.csv");
        }));
        if (sent == SIGKILL) {
            EXPECT_EQ(run("sweep " + name).exit_code, 75);
            expect_in(run("collect " + name).out, " running");
        }
        kill(sweep, sent);
        int status = 0;
        waitpid(sweep, &status, 0);
        if (sent == SIGTERM) {
            EXPECT_EQ(WEXITSTATUS(status), 3);
            const Said said = run("collect " + name);
            expect_in(said.out, "interrupted");
            EXPECT_EQ(said.out.find("running"), std::string::npos) << said.out;
        }
        EXPECT_NE(results(name), results("whole"));
        const Said again = run("sweep " + name + " --checkpoint-interval 0.05 -q");
        EXPECT_EQ(again.exit_code, 0) << again.err;
        EXPECT_EQ(results(name), results("whole"));
        EXPECT_EQ(text_of(folder / name / "table.csv"), text_of(folder / "whole/table.csv"));
    }
}

TEST_F(SweepOfRuns, RunsNoMorePointsAtATimeThanThereIsMemoryFor)
{
    if (sanitized) GTEST_SKIP() << "sanitizers take address space";
    const std::string limit = "prlimit --as=300000000 ";  // 300 MB; a point needs about 50 MB
    const std::string points = "sweep w.json --sweep /steps/1/stress=1:8:8 -q --out ";
    const auto limited = [&](const std::string& arguments) { return run(arguments, limit); };
    const Said many = limited(points + "s --jobs 8");
    EXPECT_EQ(many.exit_code, 65) << many.err;
    expect_in(many.err, "--jobs: must be <= ");
    EXPECT_EQ(limited(points + "t").exit_code, 0);
}

TEST_F(SweepOfRuns, EndsBeforeItsWallTimeAndSaysWhatIsLeft)
{
    write_flow("3000");
    const Said said =
        run("sweep w.json --out s --sweep /steps/1/stress=1,2,4 --jobs 2 "
            "--max-walltime 2s");
    EXPECT_EQ(said.exit_code, 3);
    expect_in(said.err, "the wall time of 2 s is nearly over");
    expect_in(said.out, "2 interrupted, 1 waiting");
    expect_in(text_of(folder / "s/points/stress_1.log"), "exit code 3");
}

TEST_F(SweepOfRuns, IsWrittenForEnginesAndSaysHowToUseThem)
{
    const std::string command = "sweep w.json --sweep /steps/1/stress=1,2 --out s ";
    const Said slurm = run(command +
                           "--engine slurm --no-submit --jobs 5 "
                           "--slurm-options '--partition=x --time=10'");
    EXPECT_EQ(slurm.exit_code, 0) << slurm.err;
    expect_in(slurm.out, "2 waiting\njob for 2 points in s/slurm/job.sh");
    const std::string job = text_of(folder / "s/slurm/job.sh");
    for (const char* line : {"#SBATCH --array=1-2%5\n", "#SBATCH --partition=x --time=10\n",
                             "#SBATCH --signal=B:USR1@120\n", "#SBATCH --requeue\n"})
        expect_in(job, line);
    EXPECT_EQ(std::system(("bash -n '" + (folder / "s/slurm/job.sh").string() + "'").c_str()), 0);

    const Said snakemake = run(command + "--engine snakemake");
    EXPECT_EQ(snakemake.exit_code, 0) << snakemake.err;
    expect_in(snakemake.out, "snakemake --directory s --snakefile s/Snakefile --cores");
    const Said none = run(command + "--engine slurm", "PATH=/nonexistent");
    EXPECT_EQ(none.exit_code, 66);
    expect_in(none.err, "sbatch: is not on this machine");
}

}
