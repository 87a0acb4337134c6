#include "io/appended_file.h"

#include "io/run_journal.h"
#include "io/sealed_file.h"
#include "tests/io/expect_error.h"
#include "tests/io/random_frame.h"
#include "tests/io/small_disk.h"

#include <gtest/gtest.h>

namespace sigmaflow::io {
namespace {

using testing_io::bits;
using testing_io::expect_error;
using testing_io::random_frame;
using testing_io::random_sample;
using testing_io::TemporaryFolder;

TEST(AppendedFile, IsCutBackToItsMarkAndGoesOn)
{
    const TemporaryFolder folder;
    const auto path = folder / "a";
    Mark mark;
    {
        AppendedFile file(path);
        file.write("kept ");
        mark = file.mark();
        file.write("lost in a cra");
    }
    EXPECT_EQ(mark.size, 5u);
    AppendedFile again(path, mark);
    EXPECT_EQ(read_file(path), "kept ");
    again.write("new");
    const Mark later = again.mark();
    again.finish();
    EXPECT_EQ(read_file(path), "kept new");
    EXPECT_EQ(later.digest, checksum("kept new"));
}

TEST(AppendedFile, RefusesAFileThatIsNotWhatWasMarkedAndLeavesItAlone)
{
    const TemporaryFolder folder;
    const auto path = folder / "a";
    AppendedFile file(path);
    file.write("0123456789");
    const Mark mark = file.mark();
    file.finish();
    write_file(path, "012345678X and more");
    expect_error(ErrorKind::input, {"/a", "was changed in its first 10 bytes"},
                 [&] { AppendedFile(path, mark); });
    EXPECT_EQ(read_file(path), "012345678X and more");
    write_file(path, "01234");
    expect_error(ErrorKind::input, {"must have at least 10 bytes, has 5"},
                 [&] { AppendedFile(path, mark); });
    std::filesystem::remove(path);
    expect_error(ErrorKind::missing, {"/a"}, [&] { AppendedFile(path, mark); });
}

TEST(AppendedFile, AFullDiskIsAnErrorAndTheMarkStaysGood)
{
    const TemporaryFolder folder;
    const auto path = folder / "a";
    Mark mark;
    {
        AppendedFile file(path);
        file.write(std::string(1000, 'a'));
        mark = file.mark();
    }
    EXPECT_EQ(testing_io::with_file_size_limit(1500,
                                               [&] {
                                                   AppendedFile file(path, mark);
                                                   file.write(std::string(1000, 'b'));
                                               }),
              static_cast<int>(ErrorKind::no_space));
    EXPECT_EQ(std::filesystem::file_size(path), 1500u);  // half a record
    AppendedFile again(path, mark);
    EXPECT_EQ(read_file(path), std::string(1000, 'a'));
}

TEST(RunJournal, GivesBackWhatCameInItsOrderBitByBit)
{
    const TemporaryFolder folder;
    const auto path = folder / "run.journal";
    RunJournal journal(path);
    journal.append(random_sample(1), true);
    journal.append(random_frame(20, 7, 3));
    const Mark mark = journal.mark();
    journal.append(random_sample(2), false);
    journal.finish();
    RunJournal again(path, mark);
    again.append(random_sample(4), false);
    again.finish();

    std::vector<Sample> samples;
    std::vector<bool> on_grid;
    std::vector<Frame> frames;
    std::string order;
    read_journal(path, {[&](const Sample& sample, bool grid) {
                            samples.push_back(sample);
                            on_grid.push_back(grid);
                            order += 's';
                        },
                        [&](const Frame& frame) {
                            frames.push_back(frame);
                            order += 'f';
                        }});
    EXPECT_EQ(order, "sfs");
    ASSERT_EQ(samples.size(), 2u);
    EXPECT_EQ(bits(samples[0]), bits(random_sample(1)));
    EXPECT_EQ(bits(samples[1]), bits(random_sample(4)));
    EXPECT_EQ(on_grid, (std::vector<bool>{true, false}));
    ASSERT_EQ(frames.size(), 1u);
    EXPECT_EQ(frames[0].state.position, random_frame(20, 7, 3).state.position);
    EXPECT_EQ(frames[0].contacts.size(), random_frame(20, 7, 3).contacts.size());
}

TEST(RunJournal, EveryCutIsRefusedExceptBetweenEntries)
{
    const TemporaryFolder folder;
    const auto path = folder / "run.journal";
    RunJournal journal(path);
    journal.append(random_sample(1), true);
    const std::size_t one = journal.mark().size;
    journal.append(random_sample(2), true);
    journal.finish();
    const std::string whole = read_file(path);
    for (std::size_t size = 0; size < whole.size(); ++size) {
        write_file(path, whole.substr(0, size));
        int samples = 0;
        const auto read = [&] {
            read_journal(path, {[&](const Sample&, bool) { ++samples; }, [](const Frame&) {}});
        };
        if (size == 0 || size == one) {
            read();
            EXPECT_EQ(samples, size == 0 ? 0 : 1);
        } else {
            expect_error(ErrorKind::input, {"run.journal", "ends too early"}, read);
        }
    }
}

TEST(SealedFile, NoticesEveryBitThatChangesAndEveryCut)
{
    const Seal seal{"checkpoint", 3};
    const std::string file = sealed(seal, "some bytes");
    EXPECT_EQ(unsealed(file, seal, "f"), "some bytes");
    for (std::size_t bit = 0; bit < 8 * file.size(); ++bit) {
        std::string damaged = file;
        damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
        expect_error(ErrorKind::input, {"f: "}, [&] { unsealed(damaged, seal, "f"); });
    }
    for (std::size_t size = 0; size < file.size(); ++size)
        expect_error(ErrorKind::input, {"f: "}, [&] { unsealed(file.substr(0, size), seal, "f"); });
    expect_error(ErrorKind::input, {"f: "}, [&] { unsealed(file + "x", seal, "f"); });
}

TEST(SealedFile, SaysWhichKindAndVersionItIs)
{
    const std::string file = sealed({"checkpoint", 3}, "some bytes");
    expect_error(ErrorKind::input, {"f: is a checkpoint, not a record"}, [&] {
        unsealed(file, {"record", 3}, "f");
    });
    expect_error(ErrorKind::input, {"has version 3 of the format, this program reads 2"}, [&] {
        unsealed(file, {"checkpoint", 2}, "f");
    });
    const TemporaryFolder folder;
    expect_error(ErrorKind::missing, {"/none"}, [&] {
        read_sealed(folder / "none", {"checkpoint", 3});
    });
    write_sealed(folder / "c", {"checkpoint", 3}, "some bytes");
    EXPECT_EQ(read_sealed(folder / "c", {"checkpoint", 3}), "some bytes");
}

}
}
