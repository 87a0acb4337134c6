#include "io/atomic_file.h"

#include "tests/io/expect_error.h"
#include "tests/io/random_frame.h"
#include "tests/io/small_disk.h"

#include <gtest/gtest.h>

#include <fstream>

namespace sigmaflow::io {
namespace {

using testing_io::expect_error;
using testing_io::TemporaryFolder;

TEST(AtomicFile, IsReadBackAsItWasWritten)
{
    const TemporaryFolder folder;
    std::string text(1 << 20, 'x');
    for (std::size_t k = 0; k < 256; ++k) text[1000 * k] = static_cast<char>(k);
    for (const std::string& content : {std::string(), std::string("a\r\n\0b", 5), text}) {
        write_file(folder / "file", content);
        EXPECT_EQ(read_file(folder / "file"), content);
        EXPECT_EQ(folder.files(), std::vector<std::string>{"file"});
    }
}

TEST(AtomicFile, NamesThePathAndTheReasonOfTheSystem)
{
    const TemporaryFolder folder;
    write_file(folder / "file", "text");
    expect_error(ErrorKind::file, {(folder / "none/file").string(), "No such file or directory"},
                 [&] { write_file(folder / "none/file", "text"); });
    expect_error(ErrorKind::file, {"Not a directory"},
                 [&] { write_file(folder / "file/below", "text"); });
    std::filesystem::create_directory(folder / "below");
    expect_error(ErrorKind::file, {"Is a directory"},
                 [&] { write_file(folder / "below", "text"); });
    expect_error(ErrorKind::missing, {(folder / "none").string(), "No such file or directory"},
                 [&] { read_file(folder / "none"); });
    expect_error(ErrorKind::missing, {"is a folder"}, [&] { read_file(folder / "below"); });
    EXPECT_EQ(folder.files(), (std::vector<std::string>{"below", "file"}));
}

TEST(AtomicFile, ReportsAFullDisk)
{
    expect_error(ErrorKind::no_space, {"/dev/full", "No space left on device"},
                 [] { write_file("/dev/full", "text"); });
}

TEST(AtomicFile, KeepsTheOldFileWhenTheDiskIsFull)
{
    const TemporaryFolder folder;
    write_file(folder / "file", "old");
    const int code = testing_io::with_file_size_limit(
        1000, [&] { write_file(folder / "file", std::string(5000, 'x')); });
    EXPECT_EQ(code, static_cast<int>(ErrorKind::no_space));
    EXPECT_EQ(read_file(folder / "file"), "old");
    EXPECT_EQ(folder.files(), std::vector<std::string>{"file"});
}

TEST(AtomicFile, RefusesToReadMoreThanTheLimit)
{
    const TemporaryFolder folder;
    write_file(folder / "file", "");
    std::filesystem::resize_file(folder / "file", largest_text_file);
    EXPECT_EQ(read_file(folder / "file").size(), largest_text_file);
    std::filesystem::resize_file(folder / "file", largest_text_file + 1);
    expect_error(ErrorKind::input, {"larger than 67108864 bytes"},
                 [&] { read_file(folder / "file"); });
}

TEST(OutputFile, CanBeReadWhileItGrows)
{
    const TemporaryFolder folder;
    OutputFile file(folder / "log");
    file.write("one\n");
    EXPECT_EQ(read_file(folder / "log"), "one\n");
    OutputFile moved = std::move(file);
    moved.write("two\n");
    EXPECT_EQ(read_file(folder / "log"), "one\ntwo\n");
    moved.close();
}

}
}
