#include "io/guarded.h"

#include "tests/io/expect_error.h"
#include "tests/support/sanitized.h"

#include <gtest/gtest.h>
#include <unistd.h>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace sigmaflow::io {
namespace {

using testing_io::expect_error;
using Clock = std::chrono::steady_clock;

constexpr GuardLimits limits{};

TEST(Guarded, HandsBackTheResult)
{
    for (const std::string& result : {std::string(), std::string("run, 4 frames"),
                                      std::string("a\0b\n", 4), std::string(3'000'000, 'x')})
        EXPECT_EQ(guarded("f", limits, [&] { return result; }), result);
}

TEST(Guarded, HandsBackAnErrorAsItWas)
{
    for (const ErrorKind kind : {ErrorKind::input, ErrorKind::missing}) {
        try {
            guarded("f.h5", limits,
                    [&]() -> std::string { throw Error(kind, "f.h5:/a/value", "must be > 0"); });
            FAIL();
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), kind);
            EXPECT_EQ(error.where(), "f.h5:/a/value");
            EXPECT_EQ(error.problem(), "must be > 0");
        }
    }
    expect_error(ErrorKind::input, {"f.h5: cannot be read: odd"}, [&] {
        guarded("f.h5", limits, []() -> std::string { throw std::runtime_error("odd"); });
    });
}

TEST(Guarded, SurvivesACrash)
{
    for (const int signal : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL})
        expect_error(ErrorKind::input,
                     {"f.h5: cannot be read safely", "crashed (signal " + std::to_string(signal)},
                     [&] {
                         guarded("f.h5", limits, [&] {
                             std::signal(signal, SIG_DFL);  // not that of a sanitizer
                             raise(signal);
                             return std::string();
                         });
                     });
    expect_error(ErrorKind::input, {"f.h5", "ended the process"},
                 [] { guarded("f.h5", limits, []() -> std::string { _exit(0); }); });
}

TEST(Guarded, SaysNothingItself)
{
    testing::internal::CaptureStderr();
    guarded("f", limits, [] {
        std::fputs("noise of a library\n", stderr);
        return std::string();
    });
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Guarded, EndsWhatComputesForEver)
{
    const auto start = Clock::now();
    expect_error(ErrorKind::input, {"f.h5", "more than 1 s of computing"}, [] {
        guarded("f.h5", limits, [] {
            for (volatile int i = 0;;) i = i + 1;
            return std::string();
        });
    });
    EXPECT_LT(Clock::now() - start, std::chrono::seconds(20));
}

TEST(Guarded, EndsWhatWaitsForEver)
{
    GuardLimits short_time;
    short_time.wall_seconds = 1;
    expect_error(ErrorKind::input, {"f.h5", "more than 1 s"}, [&] {
        guarded("f.h5", short_time, [] {
            pause();
            return std::string();
        });
    });
}

TEST(Guarded, StopsWhatTakesTooMuchMemory)
{
    expect_error(ErrorKind::input,
                 {"f.h5", sanitized ? "cannot be read safely" : "needs more than 96 MiB"}, [] {
                     guarded("f.h5", limits, [] {
                         std::vector<std::vector<char>> all;
                         while (true) all.emplace_back(std::size_t{1} << 20, 'x');
                         return std::string();
                     });
                 });
    expect_error(ErrorKind::input, {"f.h5", "cannot be read safely"}, [] {
        guarded("f.h5", limits, [] {
            while (true) *static_cast<volatile char*>(std::malloc(std::size_t{1} << 20)) = 1;
            return std::string();
        });
    });
    const std::size_t some = std::size_t{60} << 20;  // within the limit
    EXPECT_EQ(guarded("f", limits, [&] { return std::to_string(std::string(some, 'x').size()); }),
              std::to_string(some));
}

}
}
