// Inputs that cannot fool the program: each ends with exit code 64, 65 or 66 and lines that say
// where and why, in less than 1 s of CPU time and 200 MB of memory, and leaves no file behind.
#include "io/guarded.h"
#include "io/particles_vtp.h"
#include "io/run_file.h"
#include "tests/io/random_frame.h"
#include "tests/support/sanitized.h"
#include "tests/workflows/measured.h"
#include "tests/workflows/program.h"

#include <sys/stat.h>
#include <vtkPolyData.h>
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

namespace sigmaflow::workflows {

namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

constexpr double most_cpu_seconds = 1, most_megabytes = 200;
std::set<std::string> files_below(const fs::path& folder)
{
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        names.insert(fs::relative(entry.path(), folder).string());
    return names;
}

std::string repeated(const std::string& text, std::size_t size)
{
    std::string result;
    result.reserve(size + text.size());
    while (result.size() < size) result += text;
    return result;
}

}

/// The program works in <folder>/work; what it says is kept elsewhere.
class BadInput : public Program {
protected:
    void SetUp() override
    {
        Program::SetUp();
        work = folder / "a/work";
        fs::create_directories(work);
    }
    void TearDown() override
    {
        if (count_ > 0)
            std::printf("%d bad inputs: %d refused, slowest %.2f s, hungriest %.0f MB\n", count_,
                        refused_, slowest_, hungriest_);
        Program::TearDown();
    }

    fs::path write(const std::string& name, const std::string& text)
    {
        return Program::write("a/work/" + name, text);
    }

    /// The line of error, without its beginning.
    std::string run_limited(const Arguments& arguments, int& code)
    {
        const Measured run = run_measured(SIGMAFLOW_PROGRAM, arguments, work, folder / "said.out",
                                          folder / "said.err");
        code = run.exit_code;
        slowest_ = std::max(slowest_, run.cpu_seconds);
        hungriest_ = std::max(hungriest_, run.megabytes);
        const std::string err = text_of(folder / "said.err");
        if (!sanitized) {
            EXPECT_LT(run.cpu_seconds, most_cpu_seconds) << arguments.back() << "\n" << err;
            EXPECT_LT(run.megabytes, most_megabytes) << arguments.back() << "\n" << err;
        }
        const std::string begin = "sigmaflow: error: ";
        return err.starts_with(begin) ? err.substr(begin.size()) : err;
    }

    void expect_refused(const Arguments& arguments, int code, const std::string& message)
    {
        int got = 0;
        const std::string said = run_limited(arguments, got);
        ++count_;
        if (got >= 64 && got <= 66) ++refused_;
        EXPECT_EQ(got, code) << arguments.back() << "\n" << said;
        EXPECT_EQ(said.substr(0, message.size()), message) << arguments.back();
        std::istringstream lines("sigmaflow: error: " + said);
        for (std::string line; std::getline(lines, line);) {
            EXPECT_TRUE(line.starts_with("sigmaflow: error: ")) << said;
            EXPECT_TRUE(std::none_of(line.begin(), line.end(), [](unsigned char c) {
                return c < 0x20 || c == 0x7F;
            })) << said;
        }
        EXPECT_EQ(text_of(folder / "said.out"), "") << arguments.back();
    }

    /// By all three commands that read JSON.
    void expect_refused_by_all(const std::string& file, int code, const std::string& message)
    {
        for (const char* command : {"run", "evaluate", "validate"})
            expect_refused({command, file}, code, message);
    }

    fs::path work;

private:
    int count_ = 0, refused_ = 0;
    double slowest_ = 0, hungriest_ = 0;
};

TEST_F(BadInput, CorpusIsRefusedAsExpected)
{
    const fs::path corpus = fs::path(SIGMAFLOW_TEST_DATA) / "bad";
    fs::copy(corpus, work, fs::copy_options::recursive);
    const std::set<std::string> before = files_below(folder);
    std::set<std::string> listed{
        "README.md", "expected.json", "beyond_schema.json", "workflows", "cases", "runs", "vtp"};
    for (const auto& one : nlohmann::json::parse(text_of(corpus / "expected.json"))) {
        const std::string file = one["file"];
        listed.insert(file);
        expect_refused({one["call"], file}, one["exit"], one["message"]);
    }
    EXPECT_EQ(files_below(corpus), listed);
    EXPECT_GE(listed.size(), 200u);
    std::set<std::string> after = files_below(folder);
    after.erase("said.out");
    after.erase("said.err");
    EXPECT_EQ(after, before);
    EXPECT_FALSE(fs::exists("/tmp/sigmaflow_stolen"));  // workflows/step_name_absolute.json
}

TEST_F(BadInput, HugeAndDeepFilesAreRefusedEarly)
{
    fs::resize_file(write("huge.0", "sigmaflo"), 20'000'000'000);  // has no blocks on the disk
    expect_refused({"validate", "huge.0"}, 65, "huge.0: is not a file that sigmaflow has sealed");
    fs::resize_file(write("huger.0", "sigmaflow sealed file\n"), 20'000'000'000);
    expect_refused({"validate", "huger.0"}, 65, "huger.0: cannot be read safely");
    fs::resize_file(write("huge.json", "["), 100'000'000);
    expect_refused_by_all("huge.json", 65,
                          "huge.json: must not be larger than 33554432 bytes, got");
    write("deep.json", std::string(100'000, '['));
    expect_refused_by_all("deep.json", 65, "deep.json:1:65: nested deeper than 64");
    write("objects.json", repeated("{\"a\":", 500'000));
    expect_refused_by_all("objects.json", 65, "objects.json:1:321: nested deeper than 64");

    constexpr std::size_t large = 31'000'000;
    const auto expect_too_much = [&](const std::string& text, const std::string& message) {
        write("large.json", text);
        expect_refused({"validate", "large.json"}, 65, "large.json:1:" + message);
    };
    for (const char* item :
         {"0,", "[],", "{},", "\"\",", "[[[[1]]]],", "{\"a\":1,\"b\":2,\"c\":3},"}) {
        write("large.json", "[" + repeated(item, large));
        int code = 0;
        const std::string said = run_limited({"validate", "large.json"}, code);
        EXPECT_EQ(code, 65) << item;
        EXPECT_NE(said.find("must not need more than 128 MiB of memory"), std::string::npos)
            << said;
    }
    expect_too_much("[\"" + std::string(large, 'a') + "\"]", "2: must not have more than 1 MiB");
    expect_too_much("[" + std::string(large, '1') + "]", "2: must not have more than 1 MiB");
    expect_too_much("[" + std::string(1'000'000, '1') + "]",
                    "2: /0: not valid JSON: the number 11");
    expect_too_much(std::string(large, '\n') + "x", "1: must not have more than 1 MiB");
    expect_too_much(std::string(large, ' '), "1: is empty");

    fs::resize_file(write("huge.vtp", "<?xml version=\"1.0\"?>"), 100'000'000);
    expect_refused({"validate", "huge.vtp"}, 65, "huge.vtp: must not be larger than");
    write("deep.vtp", "<?xml version=\"1.0\"?>" + repeated("<a>", 600'000));
    expect_refused({"validate", "deep.vtp"}, 65,
                   "deep.vtp:1:30019: must not have more than 10000 tags");
    fs::resize_file(write("huge.h5", "\x89HDF\r\n\x1a\n"), 100'000'000'000);  // sparse
    expect_refused({"validate", "huge.h5"}, 65, "huge.h5: cannot be read");
}

TEST_F(BadInput, WhatIsNoRegularFileIsNotOpened)
{
    const auto all = [&](const std::string& file, const std::string& problem) {
        expect_refused_by_all(file, 66, file + ": " + problem);
    };
    const std::string special = "is not a regular file";
    fs::create_directories(work / "folder.json");
    all("folder.json", "is a folder, not a file");
    all(".", "is a folder, not a file");
    for (const char* device : {"/dev/zero", "/dev/null", "/dev/full", "/dev/random", "/dev/tty"})
        all(device, special);
    all("/dev/stdin", special);  // empty here: /dev/null
    for (const char* name : {"pipe.json", "pipe.h5", "pipe.vtp"}) {
        ASSERT_EQ(mkfifo((work / name).c_str(), 0600), 0);
        all(name, special);
    }
    fs::create_symlink("nowhere", work / "dangling.json");
    all("dangling.json", "cannot be read: No such file");
    fs::create_symlink("circle.json", work / "circle.json");
    all("circle.json", "cannot be read: Too many levels of symbolic links");
    fs::create_symlink("/dev/zero", work / "link_to_zero.json");
    all("link_to_zero.json", special);
    all("nothing.json", "cannot be read: No such file");
    all("nothing.h5", "cannot be read: No such file");
    all("folder.json/below.json", "cannot be read: No such file");
    expect_refused_by_all("", 66, "\"\": cannot be read: No such file");
    const std::string long_name(5000, 'n');
    all(long_name, "cannot be read: File name too long");
    if (geteuid() != 0) {
        fs::permissions(write("secret.json", "{}"), fs::perms::none);
        all("secret.json", "cannot be read: Permission denied");
    }
}

TEST_F(BadInput, WrongCommandLinesAreRefused)
{
    write("w.json", R"({"suspension": {"particles": 12, "size_ratio": 1, "volume_fraction": 0.2},
                        "steps": [{"step": "pack"}]})");
    for (const char* threads : {"0", "-1", "257", "1.5", "x", "", "1e2", "1000000000000", "inf"})
        expect_refused({"run", "w.json", "--threads", threads}, 64, "--threads: Value ");
    expect_refused({"run", "w.json", "--threads"}, 64, "--threads: 1 required");
    expect_refused({"run", "w.json", "--out"}, 64, "--out: 1 required");
    expect_refused({"run", "w.json", "--out", ""}, 64, "--out: must name a folder, got \"\"");
    expect_refused({"run", "w.json", "--out", "a", "--out", "b"}, 64, "--out: ");
    expect_refused({"run", "w.json", "evaluate", "w.json"}, 64, "The following argument");
    expect_refused({"run", "w.json", "--frobnicate"}, 64, "The following argument");
    expect_refused({"run"}, 64, "WORKFLOW.json is required");
    expect_refused({"evaluate"}, 64, "CASE.json is required");
    expect_refused({"validate"}, 64, "FILE is required");
    expect_refused({"-z"}, 64, "The following argument");
    expect_refused({"ran", "w.json"}, 64, "The following argument");
    expect_refused({"explain", "sheer"}, 64, "unknown step or parameter \"sheer\", did you mean \"shear\"?");
    EXPECT_EQ(files_below(work), std::set<std::string>{"w.json"});
}

// ---------------------------------------------------------------------- damaged copies of good
// files

namespace {

/// All numbers of a run, in fixed order, as one text.
std::string numbers_of(const io::StoredRun& run)
{
    std::string text;
    const auto add = [&text](const testing_io::Bits& bits) {
        text.append(reinterpret_cast<const char*>(bits.data()), bits.size() * sizeof bits[0]);
    };
    for (const Sample& sample : run.series) add(testing_io::bits(sample));
    for (const Frame& frame : run.frames) {
        add(testing_io::bits(frame.state));
        add(testing_io::bits(frame));
    }
    return text;
}

/// A damaged copy: cut off, some bits flipped, or a stretch of other bytes.
std::string damaged(const std::string& good, int number)
{
    std::mt19937 random(static_cast<unsigned>(number));
    const auto below = [&random](std::size_t limit) { return random() % limit; };
    std::string text = good;
    switch (number % 4) {
        case 0:
            return good.substr(0, below(good.size()));
        case 1:  // where the structure begins
            text[below(std::min<std::size_t>(6000, text.size()))] ^=
                static_cast<char>(1 << below(8));
            return text;
        case 2:
            text[below(text.size())] ^= static_cast<char>(1 << below(8));
            return text;
        default:
            for (std::size_t at = below(text.size()), end = std::min(at + 16, text.size());
                 at < end; ++at)
                text[at] = static_cast<char>(below(256));
            return text;
    }
}

}

TEST_F(BadInput, DamagedRunsAreRefusedOrHoldTheSameNumbers)
{
    const auto random_frame = [](unsigned seed) {
        return testing_io::random_frame(20, 7, seed, testing_io::Extremes::finite_norm);
    };
    const fs::path path = work / "run.h5";
    {
        io::RunWriter writer(path, random_frame(1).state, {}, ImposedStress{2}, {{"seed", "1"}});
        for (unsigned seed = 1; seed < 4; ++seed) {
            writer.append(random_frame(seed));
            writer.append(testing_io::random_sample(seed));
        }
        writer.finish();
    }
    const std::string good = text_of(path), numbers = numbers_of(io::read_run(path));
    int code = 0, accepted = 0, refused = 0;
    run_limited({"validate", "run.h5"}, code);
    ASSERT_EQ(code, 0) << text_of(folder / "said.err");
    EXPECT_EQ(text_of(folder / "said.out"), "run.h5: run, 3 frames of 20 particles, 3 samples\n");
    constexpr int copies = 160;
    for (int number = 0; number < copies; ++number) {
        write("run.h5", damaged(good, number));
        const std::string said = run_limited({"validate", "run.h5"}, code);
        EXPECT_TRUE(code == 0 || code == 65) << number << ": " << said;
        if (code == 65) {
            EXPECT_EQ(said.substr(0, 6), "run.h5") << said;
            ++refused;
            continue;
        }
        ++accepted;
        EXPECT_EQ(io::guarded(path, {}, [&] { return numbers_of(io::read_run(path)); }), numbers)
            << number;
    }
    std::printf("%d damaged runs: %d refused, %d with the same numbers\n", copies, refused,
                accepted);
    EXPECT_GE(refused, copies / 3);
}

TEST_F(BadInput, DamagedVtkFilesCannotTakeTheProgramDown)
{
    io::write_vtp(work / "a.vtp", io::particles_polydata(testing_io::random_frame(
                                      20, 7, 1, testing_io::Extremes::finite_norm)));
    const std::string good = text_of(work / "a.vtp");
    int code = 0, refused = 0;
    run_limited({"validate", "a.vtp"}, code);
    ASSERT_EQ(code, 0) << text_of(folder / "said.err");
    constexpr int copies = 60;
    for (int number = 0; number < copies; ++number) {
        write("a.vtp", damaged(good, number));
        const std::string said = run_limited({"validate", "a.vtp"}, code);
        EXPECT_TRUE(code == 0 || code == 65 || code == 66) << number << ": " << said;
        if (code != 0) ++refused;
    }
    std::printf("%d damaged VTK files: %d refused\n", copies, refused);
    EXPECT_GE(refused, copies / 3);
}

TEST_F(BadInput, ARunThatNoMachineCanHoldIsRefusedBeforeItStarts)
{
    write("w.json", R"({"suspension": {"particles": 1000000}, "steps": [{"step": "pack"},
        {"step": "shear", "stress": 1, "strain": 10000, "frame_interval": 0.11,
         "series_interval": 1}, {"step": "velocity_profile"}]})");
    int code = 0;
    const std::string said = run_limited({"run", "w.json", "--out", "result"}, code);
    EXPECT_EQ(code, 65) << said;
    EXPECT_NE(said.find("w.json:1:17: /suspension/particles: the step \"velocity_profile\" needs "
                        "about 50 TB of memory, more than the "),
              std::string::npos)
        << said;
    EXPECT_FALSE(std::filesystem::exists(folder / "result/pack"));
}

TEST_F(BadInput, SweepsThatStandForTooManyStepsAreRefusedEarly)
{
    std::string values = "1", steps = R"({"step": "pack"})";
    for (int k = 1; k < 1000; ++k) values += ", " + std::to_string(1 + k);
    for (int k = 1; k < 1000; ++k)
        steps += R"(, {"step": "shear", "sweep": {"stress": [)" + values + "]}}";
    write("w.json", R"({"suspension": {}, "steps": [)" + steps + "]}");
    expect_refused({"validate", "w.json"}, 65,
                   "w.json:1:29: /steps: stands for more than 1000 steps");
}

TEST_F(BadInput, ValidateSaysWhatGoodFilesAreAndNamesEveryBadOne)
{
    write("w.json", R"({"suspension": {}, "steps": [{"step": "pack"}]})");
    write("bad.json", "{}");
    write("worse.json", "[");
    const Said said = run("validate a/work/w.json a/work/bad.json '" SIGMAFLOW_TEST_DATA
                          "/cases/t01_n50_stress.json' a/work/worse.json");
    EXPECT_EQ(said.exit_code, 65);
    EXPECT_NE(said.out.find("w.json: workflow, 1 step, needs about "), std::string::npos)
        << said.out;
    EXPECT_NE(said.out.find("case, 50 particles, imposed stress 10, trajectory to strain 0.04"),
              std::string::npos)
        << said.out;
    EXPECT_NE(said.err.find("bad.json:1:1: is neither a workflow"), std::string::npos) << said.err;
    EXPECT_NE(said.err.find("worse.json:1:2: /0: not valid JSON"), std::string::npos) << said.err;
}

}
