// SPDX-License-Identifier: Apache-2.0
#include "base/format_number.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "base/random.h"

namespace tonewright {
namespace {

TEST(RoundedUp, HasSoManyDigits) {
    EXPECT_EQ(rounded_up(1.31e-7), "1.4e-07");
    EXPECT_EQ(rounded_up(1.3000001e-7), "1.4e-07");
    EXPECT_EQ(rounded_up(25.1), "2.6e+01");
    EXPECT_EQ(rounded_up(0.0012301, 3), "1.24e-03");
    EXPECT_EQ(rounded_up(2.01, 1), "3e+00");
}

TEST(RoundedUp, KeepsNumbersOfFewDigits) {
    // None of them is a double.
    EXPECT_EQ(rounded_up(1.3e-7), "1.3e-07");
    EXPECT_EQ(rounded_up(0.001), "1.0e-03");
    EXPECT_EQ(rounded_up(0.00123, 3), "1.23e-03");
    EXPECT_EQ(rounded_up(1.23e-7, 3), "1.23e-07");
}

TEST(RoundedUp, CarriesIntoTheNextPowerOfTen) {
    EXPECT_EQ(rounded_up(9.91e-5), "1.0e-04");
    EXPECT_EQ(rounded_up(9.991, 3), "1.00e+01");
}

TEST(RoundedUp, PassesOtherNumbersOn) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(rounded_up(0), "0");
    EXPECT_EQ(rounded_up(0, 3), "0");
    EXPECT_EQ(rounded_up(kInfinity), "inf");
    EXPECT_EQ(rounded_up(std::nan("")), "nan");
    EXPECT_EQ(round_up(-1.234, 2), -1.234);
}

TEST(RoundedUp, IsNeverLessAndLessThanOneUnitMore) {
    SampleRandom random(12);
    for (int i = 0; i < 10000; ++i) {
        const double x = std::exp2(random.uniform(-60, 20));
        for (const int digits : {1, 2, 3}) {
            const double most = x * (1 + std::pow(10.0, 1 - digits));
            const double printed = std::stod(rounded_up(x, digits));
            // 1e-9 of the last digit: what separates 1.3e-7 from the double next to it.
            ASSERT_GE(printed, x * (1 - 1e-9)) << shortest(x);
            ASSERT_LE(printed, most * (1 + 1e-9)) << shortest(x);
            ASSERT_NEAR(round_up(x, digits), printed, 1e-12 * x) << shortest(x);
        }
    }
}

}  // namespace
}  // namespace tonewright
