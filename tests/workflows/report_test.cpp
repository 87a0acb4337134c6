#include "workflows/report.h"

#include "workflows/progress.h"

#include <gtest/gtest.h>
#include <cmath>
#include <nlohmann/json.hpp>

namespace sigmaflow::workflows {

TEST(Report, ShowsTheErrorWithTwoDigitsAndTheValueWithAsManyDecimals)
{
    EXPECT_EQ(with_error(0.0192345, 0.0011), "0.0192 +- 0.0011");
    EXPECT_EQ(with_error(161.27, 5.2), "161.3 +- 5.2");
    EXPECT_EQ(with_error(-3.14159, 0.25), "-3.14 +- 0.25");
    EXPECT_EQ(with_error(161.27, 12), "161 +- 12");
    EXPECT_EQ(with_error(1612.7, 123), "1610 +- 120");
    EXPECT_EQ(with_error(422.3, 131), "420 +- 130");
    EXPECT_EQ(with_error(3, 4e7), "3 +- 4.0e+07");
}

TEST(Report, ShowsAValueWithoutErrorAlone)
{
    EXPECT_EQ(with_error(2, 0), "2");
    EXPECT_EQ(with_error(2, std::nan("")), "2");
    EXPECT_EQ(with_error(2, 1e-16), "2");  // rounding
    EXPECT_EQ(with_error(std::nan(""), 1), "undefined");
}

TEST(Report, TableHasOneLinePerMean)
{
    const auto summary = nlohmann::ordered_json::parse(R"({"steps": {
        "pack": {"step": "pack", "seed": 1},
        "shear": {"step": "shear", "outcome": "flowing", "averages_from_strain": 0.4,
                  "shear_rate": {"mean": 0.02, "standard_error": 0.001, "unit": "rate0"},
                  "viscosity": {"mean": 100, "standard_error": null, "unit": "eta0"}}}})");
    EXPECT_EQ(table(summary),
              "shear: flowing, shear rate 0.0200 +- 0.0010, averages from strain 0.4\n"
              "  shear_rate                    0.0200 +- 0.0010        rate0\n"
              "  viscosity                     100                     eta0\n");
}

TEST(Progress, ShowsDurationsInTwoUnitsAtMost)
{
    EXPECT_EQ(duration_text(0.4), "0 s");
    EXPECT_EQ(duration_text(59.4), "59 s");
    EXPECT_EQ(duration_text(185), "3 min 05 s");
    EXPECT_EQ(duration_text(7860), "2 h 11 min");
    EXPECT_EQ(duration_text(-1), "0 s");
}

}
