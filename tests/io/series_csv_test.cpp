#include "io/series_csv.h"

#include "io/atomic_file.h"
#include "tests/io/expect_error.h"
#include "tests/io/random_frame.h"

#include <gtest/gtest.h>

#include <sstream>

namespace sigmaflow::io {
namespace {

using testing_io::bits;
using testing_io::expect_error;
using testing_io::random_sample;
using testing_io::TemporaryFolder;

std::filesystem::path written_series(const TemporaryFolder& folder, unsigned rows)
{
    SeriesWriter writer(folder / "series.csv");
    for (unsigned seed = 0; seed < rows; ++seed) writer.append(random_sample(seed));
    writer.finish();
    return folder / "series.csv";
}

std::vector<std::string> lines(const std::filesystem::path& path)
{
    std::vector<std::string> result;
    std::istringstream text(read_file(path));
    for (std::string line; std::getline(text, line);) result.push_back(line);
    return result;
}

TEST(SeriesCsv, IsReadBackBitByBit)
{
    const TemporaryFolder folder;
    const auto series = read_series(written_series(folder, 300));
    ASSERT_EQ(series.size(), 300u);
    for (unsigned seed = 0; seed < 300; ++seed)
        EXPECT_EQ(bits(series[seed]), bits(random_sample(seed))) << seed;
}

TEST(SeriesCsv, HasUnitsNamesAndOneRowPerSample)
{
    const TemporaryFolder folder;
    const auto text = lines(written_series(folder, 2));
    ASSERT_EQ(text.size(), 4u);
    EXPECT_EQ(text[0].substr(0, 2), "# ");
    EXPECT_NE(text[0].find("shear_stress [sigma0]"), std::string::npos);
    EXPECT_EQ(text[1].substr(0, 23), "strain,time,shear_rate,");
    const auto commas = [](const std::string& line) {
        return std::count(line.begin(), line.end(), ',');
    };
    EXPECT_EQ(commas(text[1]), static_cast<long>(sample_fields().size()) - 1);
    EXPECT_EQ(commas(text[2]), commas(text[1]));
}

TEST(SeriesCsv, MayHaveNoRows)
{
    const TemporaryFolder folder;
    EXPECT_TRUE(read_series(written_series(folder, 0)).empty());
}

TEST(SeriesCsv, ShowsEveryRowAtOnce)
{
    const TemporaryFolder folder;
    SeriesWriter writer(folder / "series.csv");
    for (unsigned row = 0; row < 3; ++row) {
        EXPECT_EQ(read_series(folder / "series.csv").size(), row);
        writer.append(random_sample(row));
    }
}

TEST(SeriesCsv, NamesFileLineAndColumnOfBadContent)
{
    const TemporaryFolder folder;
    const std::filesystem::path path = written_series(folder, 2);
    const auto good = lines(path);
    const auto with = [&](const std::string& last) {
        write_file(path, good[0] + '\n' + good[1] + '\n' + good[2] + '\n' + last);
        return [&path] { read_series(path); };
    };
    expect_error(ErrorKind::input, {"series.csv:4", "time", "\"x\""}, with("1,x,3\n"));
    expect_error(ErrorKind::input, {"series.csv:4", "shear_rate"}, with("1,2"));
    expect_error(ErrorKind::input, {"series.csv:4", "more columns"}, with(good[3] + ",5\n"));
    expect_error(ErrorKind::input, {"series.csv:4", "strain"}, with("\n"));
    write_file(path, "a,b\n1,2\n");
    expect_error(ErrorKind::input, {"series.csv:1", "columns must be strain,time"},
                 [&] { read_series(path); });
    write_file(path, "");
    expect_error(ErrorKind::input, {"names of the columns"}, [&] { read_series(path); });
    expect_error(ErrorKind::missing, {"none.csv"}, [&] { read_series(folder / "none.csv"); });
}

TEST(SeriesCsv, ReportsAFullDiskAndAnUnwritablePlace)
{
    expect_error(ErrorKind::no_space, {"/dev/full"}, [] { SeriesWriter writer("/dev/full"); });
    const TemporaryFolder folder;
    write_file(folder / "file", "");
    expect_error(ErrorKind::file, {"Not a directory"},
                 [&] { SeriesWriter writer(folder / "file/series.csv"); });
}

}
}
