#include "io/run_file.h"

#include "io/atomic_file.h"
#include "tests/io/expect_error.h"
#include "tests/io/random_frame.h"
#include "tests/io/small_disk.h"

#include <gtest/gtest.h>
#include <hdf5.h>

#include <sys/syscall.h>
#include <unistd.h>

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/lsan_interface.h>
#endif

#include <cerrno>
#include <chrono>
#include <functional>
#include <thread>

namespace {

long writes_left = -1;  // then one fails; negative: none

}

/// In front of that of the C library, for HDF5.
extern "C" ssize_t pwrite(int file, const void* bytes, size_t count, off_t offset)
{
    if (writes_left-- == 0) {
        errno = ENOSPC;
        return -1;
    }
    return syscall(SYS_pwrite64, file, bytes, count, offset);
}

namespace sigmaflow::io {
namespace {

using testing_io::bits;
using testing_io::expect_error;
using testing_io::random_frame;
using testing_io::random_sample;
using testing_io::TemporaryFolder;

const Provenance texts{
    {"version", "0.1.0"}, {"seed", "7"}, {"host", "a \xce\xb3 b"}, {"empty", ""}};

/// Frames and samples are written in turns, as in a run.
std::filesystem::path write_run(const std::filesystem::path& path, const std::vector<Frame>& frames,
                                const std::vector<Sample>& series, const State& first,
                                const Model& model = {}, const Control& control = ImposedStress{2})
{
    RunWriter writer(path, first, model, control, texts);
    for (std::size_t k = 0; k < std::max(frames.size(), series.size()); ++k) {
        if (k < series.size()) writer.append(series[k]);
        if (k < frames.size()) writer.append(frames[k]);
        if (k % 3 == 0) writer.flush();
    }
    writer.finish();
    return path;
}

std::vector<Sample> random_series(unsigned count)
{
    std::vector<Sample> series;
    for (unsigned seed = 0; seed < count; ++seed) series.push_back(random_sample(seed));
    return series;
}

void expect_same_run(const StoredRun& run, const std::vector<Frame>& frames,
                     const std::vector<Sample>& series)
{
    ASSERT_EQ(run.frames.size(), frames.size());
    for (std::size_t k = 0; k < frames.size(); ++k) {
        EXPECT_EQ(bits(run.frames[k].state), bits(frames[k].state)) << k;
        EXPECT_EQ(bits(run.frames[k]), bits(frames[k])) << k;
        EXPECT_EQ(run.frames[k].state.contacts.size(), frames[k].state.contacts.size());
        EXPECT_EQ(run.frames[k].contacts.size(), frames[k].contacts.size());
    }
    ASSERT_EQ(run.series.size(), series.size());
    for (std::size_t k = 0; k < series.size(); ++k) EXPECT_EQ(bits(run.series[k]), bits(series[k]));
}

TEST(RunFile, IsReadBackBitByBit)
{
    const TemporaryFolder folder;
    std::vector<Frame> frames;
    for (unsigned seed = 0; seed < 7; ++seed)  // with 0, 5, 10, ... contacts
        frames.push_back(random_frame(41, static_cast<int>(5 * seed), seed));
    const std::vector<Sample> series = random_series(1000);
    const StoredRun run =
        read_run(write_run(folder / "run.h5", frames, series, frames.front().state));
    expect_same_run(run, frames, series);
    EXPECT_EQ(run.provenance, texts);
    EXPECT_EQ(folder.files(), std::vector<std::string>{"run.h5"});
}

TEST(RunFile, MayHaveOneParticleNoContactsAndOneFrame)
{
    const TemporaryFolder folder;
    const std::vector<Frame> frames{random_frame(1, 0, 1)};
    const auto path = write_run(folder / "run.h5", frames, {}, frames.front().state);
    expect_same_run(read_run(path), frames, {});
}

TEST(RunFile, MayHaveNoFramesAndNoSamples)
{
    const TemporaryFolder folder;
    const auto path = write_run(folder / "run.h5", {}, {}, random_frame(3, 0, 1).state);
    expect_same_run(read_run(path), {}, {});
}

TEST(RunFile, KeepsFramesOfManyParticles)
{
    const TemporaryFolder folder;
    const std::vector<Frame> frames{random_frame(5000, 3000, 2), random_frame(5000, 4999, 3)};
    const auto path = write_run(folder / "run.h5", frames, {}, frames.front().state);
    expect_same_run(read_run(path), frames, {});
}

TEST(RunFile, KeepsTheModelAndTheControl)
{
    const TemporaryFolder folder;
    Model model;
    model.lubrication_delta = 0.1 + 0.2;  // a number that needs 17 digits
    model.contact_hydrodynamics = ContactHydrodynamics::dashpot;
    model.stiffness_scale = StiffnessScale::fixed;
    model.repulsion_amplitude = RepulsionAmplitude::derjaguin;
    model.friction_static = 0.5;
    model.friction_dynamic = 1.0 / 3;
    model.rolling_friction = 0.25;
    model.einstein = false;
    const Control control = ImposedRate{-0.7};
    const auto path =
        write_run(folder / "run.h5", {}, {}, random_frame(2, 0, 1).state, model, control);
    const StoredRun run = read_run(path);
    EXPECT_EQ(run.model.lubrication_delta, 0.1 + 0.2);
    EXPECT_EQ(run.model.contact_hydrodynamics, ContactHydrodynamics::dashpot);
    EXPECT_EQ(run.model.stiffness_scale, StiffnessScale::fixed);
    EXPECT_EQ(run.model.repulsion_amplitude, RepulsionAmplitude::derjaguin);
    EXPECT_EQ(run.model.normal_stiffness, Model{}.normal_stiffness);
    EXPECT_EQ(run.model.friction_static, 0.5);
    EXPECT_EQ(run.model.friction_dynamic, 1.0 / 3);
    EXPECT_EQ(run.model.rolling_friction, 0.25);
    EXPECT_FALSE(run.model.einstein);
    EXPECT_TRUE(run.model.background_drag);
    ASSERT_TRUE(std::holds_alternative<ImposedRate>(run.control));
    EXPECT_EQ(std::get<ImposedRate>(run.control).value, -0.7);
}

TEST(RunFile, KeepsLongTexts)
{
    const TemporaryFolder folder;
    const Provenance provenance{
        {"workflow", std::string(300000, 'w')}};  // limit of old HDF5: 64 KiB
    RunWriter writer(folder / "run.h5", random_frame(2, 0, 1).state, {}, ImposedStress{},
                     provenance);
    writer.finish();
    EXPECT_EQ(read_run(folder / "run.h5").provenance, provenance);
}

TEST(RunFile, HasItsNameOnlyWhenItIsComplete)
{
    const TemporaryFolder folder;
    const Frame frame = random_frame(4, 2, 1);
    {
        RunWriter writer(folder / "run.h5", frame.state, {}, ImposedStress{}, {});
        writer.append(frame);
        EXPECT_EQ(folder.files(), std::vector<std::string>{"run.h5.part"});
    }
    EXPECT_EQ(folder.files(), std::vector<std::string>{"run.h5.part"});
    EXPECT_EQ(read_run(folder / "run.h5.part").frames.size(), 1u);
}

TEST(RunFile, CanBeMovedWhileItIsWritten)
{
    const TemporaryFolder folder;
    const Frame frame = random_frame(4, 2, 1);
    RunWriter first(folder / "run.h5", frame.state, {}, ImposedStress{}, {});
    first.append(frame);
    RunWriter second = std::move(first);
    second.append(frame);
    second.finish();
    EXPECT_EQ(read_run(folder / "run.h5").frames.size(), 2u);
}

TEST(RunFile, IsIdenticalForIdenticalRuns)
{
    const TemporaryFolder folder;
    const std::vector<Frame> frames{random_frame(10, 5, 1), random_frame(10, 3, 2)};
    write_run(folder / "a.h5", frames, random_series(5), frames.front().state);
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // HDF5 likes to note seconds
    write_run(folder / "b.h5", frames, random_series(5), frames.front().state);
    EXPECT_EQ(read_file(folder / "a.h5"), read_file(folder / "b.h5"));
}

TEST(RunFile, RefusesOtherParticlesInTheSameRun)
{
    const TemporaryFolder folder;
    RunWriter writer(folder / "run.h5", random_frame(4, 0, 1).state, {}, ImposedStress{}, {});
    expect_error(ErrorKind::internal, {"radii must not change"},
                 [&] { writer.append(random_frame(5, 0, 1)); });
    Frame incomplete = random_frame(4, 0, 1);
    incomplete.velocity.pop_back();
    expect_error(ErrorKind::internal, {"velocity", "4 entries, got 3"},
                 [&] { writer.append(incomplete); });
    expect_error(ErrorKind::input, {"at least one particle"},
                 [&] { RunWriter(folder / "none.h5", State{}, {}, ImposedStress{}, {}); });
}

TEST(RunFile, NamesAFolderThatCannotBeWritten)
{
    const TemporaryFolder folder;
    write_file(folder / "file", "");
    const State state = random_frame(2, 0, 1).state;
    testing::internal::CaptureStderr();
    expect_error(ErrorKind::file, {"file/run.h5.part", "Not a directory"},
                 [&] { RunWriter(folder / "file/run.h5", state, {}, ImposedStress{}, {}); });
    expect_error(ErrorKind::file, {"none/run.h5.part", "No such file or directory"},
                 [&] { RunWriter(folder / "none/run.h5", state, {}, ImposedStress{}, {}); });
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

/// The disk gets full at many different moments: opening, attributes, frames, flushing, closing.
class FullDisk : public testing::TestWithParam<int> {};

TEST_P(FullDisk, IsAnErrorAndLeavesNoRunFile)
{
    const TemporaryFolder folder;
    const std::vector<Frame> frames(20, random_frame(50, 30, 1));
    const int code = testing_io::with_file_size_limit(static_cast<rlim_t>(GetParam()), [&] {
        write_run(folder / "run.h5", frames, random_series(600), frames.front().state);
    });
    EXPECT_EQ(code, static_cast<int>(ErrorKind::no_space));
    for (const std::string& name : folder.files()) EXPECT_EQ(name, "run.h5.part");
}
INSTANTIATE_TEST_SUITE_P(Bytes, FullDisk,
                         testing::Values(0, 50, 1000, 5000, 20000, 60000, 100000, 150000, 200000,
                                         250000, 300000, 350000));

/// HDF5 1.10 forgets a kilobyte of its own when one of its writes fails: not our leak.
class WithoutLeakSearch {
#if defined(__SANITIZE_ADDRESS__)
    __lsan::ScopedDisabler disabler_;
#endif
};

// Unlike on a full disk, what comes after the failure succeeds.
TEST(RunFile, ASingleWriteThatFailsIsAnErrorWhicheverItIs)
{
    const TemporaryFolder folder;
    const std::vector<Frame> frames(4, random_frame(50, 30, 1));
    const auto write = [&] {
        write_run(folder / "run.h5", frames, random_series(20), frames.front().state);
    };
    for (long number = 0; number < 1000; ++number) {
        writes_left = number;
        try {
            [[maybe_unused]] const WithoutLeakSearch disabled;
            write();
            ASSERT_GE(writes_left, 0) << "write " << number << " failed unnoticed";
            writes_left = -1;
            EXPECT_GT(number, 50);
            return;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::no_space) << error.what();
            EXPECT_FALSE(std::filesystem::exists(folder / "run.h5"));
        }
        writes_left = -1;
    }
    FAIL() << "more than 1000 writes";
}

TEST(RunFile, IsWrittenWhereTheDiskIsLargeEnough)  // the limit itself does no harm
{
    const TemporaryFolder folder;
    const std::vector<Frame> frames(20, random_frame(50, 30, 1));
    const int code = testing_io::with_file_size_limit(10000000, [&] {
        write_run(folder / "run.h5", frames, random_series(600), frames.front().state);
    });
    EXPECT_EQ(code, 0);
    EXPECT_EQ(read_run(folder / "run.h5").frames.size(), 20u);
    EXPECT_GT(std::filesystem::file_size(folder / "run.h5"),
              400000u);  // above all limits of FullDisk
}

TEST(ReadRun, RefusesForeignFiles)
{
    const TemporaryFolder folder;
    expect_error(ErrorKind::missing, {"none.h5", "No such file"},
                 [&] { read_run(folder / "none.h5"); });
    write_file(folder / "text.h5", "not HDF5");
    expect_error(ErrorKind::input, {"text.h5", "cannot be read"},
                 [&] { read_run(folder / "text.h5"); });
    write_file(folder / "empty.h5", "");
    expect_error(ErrorKind::input, {"empty.h5"}, [&] { read_run(folder / "empty.h5"); });
    const std::string path = folder / "other.h5";
    H5Fclose(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
    expect_error(ErrorKind::input, {"other.h5", "sigmaflow_schema"}, [&] { read_run(path); });
}

void set_schema(hid_t file, int schema)
{
    const hid_t attribute = H5Aopen(file, "sigmaflow_schema", H5P_DEFAULT);
    H5Awrite(attribute, H5T_NATIVE_INT, &schema);
    H5Aclose(attribute);
}

class DamagedRun : public testing::Test {
protected:
    void SetUp() override
    {
        frames_ = {random_frame(20, 5, 1), random_frame(20, 9, 2)};
        write_run(path_, frames_, random_series(10), frames_.front().state);
    }
    /// Opens the file with plain HDF5.
    void change(const std::function<void(hid_t)>& edit)
    {
        const hid_t file = H5Fopen(path_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
        ASSERT_GE(file, 0);
        edit(file);
        H5Fclose(file);
    }
    void overwrite(const std::string& name, hid_t type, const void* values)
    {
        change([&](hid_t file) {
            const hid_t dataset = H5Dopen2(file, name.c_str(), H5P_DEFAULT);
            ASSERT_GE(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), 0);
            H5Dclose(dataset);
        });
    }
    void expect_refused(std::initializer_list<std::string> words)
    {
        testing::internal::CaptureStderr();
        expect_error(ErrorKind::input, words, [&] { read_run(path_); });
        EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    }

    TemporaryFolder folder_;
    std::filesystem::path path_ = folder_ / "run.h5";
    std::vector<Frame> frames_;
};

TEST_F(DamagedRun, IsRefusedWhenItIsCutOff)
{
    const auto size = std::filesystem::file_size(path_);
    for (const auto kept : {size - 1, size / 2, std::uintmax_t{100}}) {
        std::filesystem::resize_file(path_, kept);
        expect_refused({path_.string()});
    }
}

TEST_F(DamagedRun, IsRefusedWhenADatasetIsMissing)
{
    change(
        [](hid_t file) { H5Ldelete(file, "/particles/trajectory/velocity/value", H5P_DEFAULT); });
    expect_refused({path_.string() + ":/particles/trajectory/velocity/value"});
}

TEST_F(DamagedRun, IsRefusedWhenABitIsWrong)
{
    // a position appears in the file as it is in memory
    std::string content = read_file(path_);
    const double number = frames_[1].state.position[7].x();
    const std::size_t at =
        content.find(std::string(reinterpret_cast<const char*>(&number), sizeof number));
    ASSERT_NE(at, std::string::npos);
    content[at] ^= 1;
    write_file(path_, content);
    expect_refused({path_.string() + ":/particles/trajectory/position/value"});
}

TEST_F(DamagedRun, IsRefusedWhenTheShapeIsWrong)
{
    change([](hid_t file) {
        const hid_t dataset = H5Dopen2(file, "/particles/trajectory/stress/value", H5P_DEFAULT);
        const hsize_t shape[4] = {1, 20, 3, 3};
        ASSERT_GE(H5Dset_extent(dataset, shape), 0);
        H5Dclose(dataset);
    });
    expect_refused({"/particles/trajectory/stress/value", "[2 x 20 x 3 x 3]", "[1 x 20 x 3 x 3]"});
}

TEST_F(DamagedRun, IsRefusedBeforeMemoryForAnAbsurdShapeIsTaken)
{
    change([](hid_t file) {
        const hid_t dataset = H5Dopen2(file, "/particles/trajectory/position/time", H5P_DEFAULT);
        const hsize_t shape[1] = {hsize_t{1} << 50};
        ASSERT_GE(H5Dset_extent(dataset, shape), 0);
        H5Dclose(dataset);
    });
    expect_refused({"/particles/trajectory/position/time", "must hold all values"});
}

TEST_F(DamagedRun, IsRefusedWhenValuesHaveNoChecksum)
{
    change([](hid_t file) {
        const hid_t dataset = H5Dopen2(file, "/particles/trajectory/position/value", H5P_DEFAULT);
        const hsize_t start[3] = {0, 0, 0};
        const std::vector<double> zeros(1020);  // a chunk: 17 frames of 20 particles
        const std::uint32_t without_filters = 1;
        ASSERT_GE(
            H5Dwrite_chunk(dataset, H5P_DEFAULT, without_filters, start, 1020 * 8, zeros.data()),
            0);
        H5Dclose(dataset);
    });
    expect_refused({"/particles/trajectory/position/value", "must have values with a checksum"});
}

TEST_F(DamagedRun, IsRefusedWhenAContactHasNoParticle)
{
    const std::vector<std::int32_t> wrong(14, 20);  // particles are 0 ... 19
    overwrite("/state/contacts/j", H5T_NATIVE_INT32, wrong.data());
    expect_refused({"/state/contacts/j", "i < j < 20", "got 0, 20"});
}

TEST_F(DamagedRun, IsRefusedWhenContactsLieOutsideTheTable)
{
    const std::int64_t wrong[2] = {5, 10};
    overwrite("/contacts/count", H5T_NATIVE_INT64, wrong);
    expect_refused({"/contacts/count", "frame 1", "within 14 rows", "10 from 5"});
}

TEST_F(DamagedRun, IsRefusedWhenAParameterIsUnknownOrMissing)
{
    change([](hid_t file) {
        const hid_t group = H5Gopen2(file, "/parameters", H5P_DEFAULT);
        H5Arename(group, "debye_length", "debye_lenth");
        H5Gclose(group);
    });
    expect_refused({"/parameters", "debye_length"});
}

TEST_F(DamagedRun, IsRefusedWhenItComesFromALaterVersion)
{
    change([](hid_t file) { set_schema(file, 3); });
    expect_refused({"must have the schema 1 or 2", "got 3"});
}

TEST_F(DamagedRun, IsReadWhenItComesFromTheFirstVersion)
{
    change([](hid_t file) { set_schema(file, 1); });
    EXPECT_NO_THROW(read_run(path_));
}

}
}
