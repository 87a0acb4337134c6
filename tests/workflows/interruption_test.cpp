#include "workflows/interruption.h"

#include <gtest/gtest.h>
#include <csignal>

namespace sigmaflow::workflows {

TEST(Interruption, ReadsTheTimesOfPeopleAndOfBatchSystems)
{
    EXPECT_EQ(seconds_of("90"), 90);
    EXPECT_EQ(seconds_of("45s"), 45);
    EXPECT_EQ(seconds_of("30m"), 1800);
    EXPECT_EQ(seconds_of("2h"), 7200);
    EXPECT_EQ(seconds_of("1d"), 86400);
    EXPECT_EQ(seconds_of("1.5h"), 5400);
    EXPECT_EQ(seconds_of("01:30:15"), 5415);
    EXPECT_EQ(seconds_of("1-12:00:00"), 36 * 3600);
    for (const char* bad : {"", "h", "-5", "0", "5x", "2 h", "1:2:3:4", "nan", "inf", "1e999", "1-",
                            "-1-00:00:00", "5m5", "0x10"})
        EXPECT_FALSE(seconds_of(bad)) << bad;
}

TEST(Interruption, SignalsAndTheWallTimeAreRequests)
{
    const Interruption timed(1000.);
    EXPECT_FALSE(timed.asked(10));
    ASSERT_TRUE(timed.asked(2000));
    EXPECT_NE(timed.asked(2000)->find("wall time"), std::string::npos);
    const Interruption untimed(std::nullopt);
    EXPECT_FALSE(untimed.asked(1e9));
    std::raise(SIGUSR1);  // would end the program
    EXPECT_EQ(untimed.asked(), "SIGUSR1");
}

}
