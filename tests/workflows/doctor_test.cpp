// sigmaflow doctor: faults that are provoked are named with their mend.
#include "workflows/doctor.h"

#include "tests/io/small_disk.h"
#include "tests/workflows/program.h"

#include <nlohmann/json.hpp>

namespace sigmaflow::workflows {

namespace {

class Doctor : public Program {
protected:
    struct Line {
        std::string level, text, mend;
    };

    Line line(const std::string& check, const std::string& environment = "",
              const std::string& where = ".", int code = 0)
    {
        const Said said = run("doctor " + where + " --json", environment);
        EXPECT_EQ(said.exit_code, code) << said.out << said.err;
        const auto report = nlohmann::json::parse(said.out);
        for (const auto& one : report["checks"])
            if (one["name"] == check) return {one["level"], one["text"], one["mend"]};
        return {};
    }
};

}

TEST_F(Doctor, FindsThisMachineHealthyAndLeavesNothingBehind)
{
    const Said said = run("doctor");
    EXPECT_EQ(said.exit_code, 0) << said.out << said.err;
    for (const char* check : {"pictures", "fonts", "hdf5", "vtk", "folder", "lock"})
        EXPECT_NE(said.out.find("OK    " + std::string(check)), std::string::npos) << said.out;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        EXPECT_TRUE(entry.path().filename().string().starts_with("said.")) << entry.path();
}

TEST_F(Doctor, NamesAMissingDriver)
{
    const Line found = line("pictures", "__EGL_VENDOR_LIBRARY_FILENAMES=/dev/null", ".", 69);
    EXPECT_EQ(found.level, "FAIL") << found.text;
    EXPECT_NE(found.mend.find("libgl1-mesa-dri"), std::string::npos) << found.mend;
}

TEST_F(Doctor, NamesAFolderThatCannotBeWritten)
{
    // /proc is read-only for everybody, root included
    const Line found = line("folder", "", "/proc", 73);
    EXPECT_EQ(found.level, "FAIL") << found.text;
    EXPECT_NE(found.mend.find("that you can write to"), std::string::npos) << found.mend;
    EXPECT_EQ(run("doctor nowhere").exit_code, 66);
}

TEST_F(Doctor, NamesAFullDisk)
{
    const int code = testing_io::with_file_size_limit(4096, [&] {
        const Finding found = examine_folder(folder);
        if (found.level != Finding::Level::fail ||
            found.mend.find("disk is full") == std::string::npos)
            throw Error(ErrorKind::internal, "", found.text);
        throw Error(found.kind, "", found.text);
    });
    EXPECT_EQ(code, static_cast<int>(ErrorKind::no_space));
}

TEST_F(Doctor, NamesALimitOfMemory)
{
    const std::string command = "cd '" + folder.string() + "' && ulimit -v 1000000 && '" +
                                SIGMAFLOW_PROGRAM + "' doctor >limited.out 2>limited.err";
    std::system(command.c_str());
    const std::string out = text_of(folder / "limited.out");
    EXPECT_NE(out.find("WARN  memory"), std::string::npos) << out;
    EXPECT_NE(out.find("mend: raise it: ulimit -v unlimited"), std::string::npos) << out;
}

TEST_F(Doctor, NamesALocaleThatIsNotThereAndASlowKernel)
{
    const Line locale = line("locale", "LC_ALL=xx_YY.UTF-8");
    EXPECT_EQ(locale.level, "WARN") << locale.text;
    EXPECT_NE(locale.mend.find("LC_ALL=C.UTF-8"), std::string::npos) << locale.mend;
    const Line blas = line("blas", "OPENBLAS_CORETYPE=Prescott");
    EXPECT_EQ(blas.level, "WARN") << blas.text;
    EXPECT_NE(blas.mend.find("OPENBLAS_CORETYPE"), std::string::npos) << blas.mend;
}

TEST(DoctorJudges, ProcessorsClocksAndQuotasOfOtherMachines)
{
    using Level = Finding::Level;
    EXPECT_EQ(judge_instructions("x86-64-v4, OpenBLAS SkylakeX").level, Level::ok);
    EXPECT_EQ(judge_instructions("x86-64-v3, OpenBLAS Haswell").level, Level::ok);
    const Finding old = judge_instructions("x86-64, OpenBLAS Prescott");
    EXPECT_EQ(old.level, Level::warn);
    EXPECT_NE(old.text.find("no AVX2"), std::string::npos);
    EXPECT_FALSE(old.mend.empty());

    EXPECT_EQ(judge_clock(1.8e9, 0.5).level, Level::ok);
    EXPECT_EQ(judge_clock(0, 0).level, Level::warn);
    const Finding skew = judge_clock(1.8e9, -3600);
    EXPECT_EQ(skew.level, Level::warn);
    EXPECT_NE(skew.text.find("-3600 s"), std::string::npos) << skew.text;

    EXPECT_EQ(judge_threads(8, 8, std::nullopt).level, Level::ok);
    const Finding quota = judge_threads(64, 64, 2.5);
    EXPECT_EQ(quota.level, Level::warn);
    EXPECT_NE(quota.mend.find("--threads 2"), std::string::npos) << quota.mend;

    EXPECT_EQ(judge_memory(100e9, "left").level, Level::ok);
    EXPECT_EQ(judge_memory(70e6, "left").level, Level::fail);
    EXPECT_EQ(judge_memory(std::nullopt, "").level, Level::info);
}

}
