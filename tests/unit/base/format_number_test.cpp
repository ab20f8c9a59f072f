// SPDX-License-Identifier: Apache-2.0
#include "base/format_number.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "base/random.h"
#include "lut/clf.h"
#include "unit/hard_floats.h"

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

TEST(Numbers, RoundTripInNineDigitsWithoutExponents) {
    for (const float x : hard_floats(200000)) {
        std::string text;
        append_number(text, x);
        ASSERT_EQ(text.find_first_not_of("-0123456789."), std::string::npos) << text;
        ASSERT_TRUE(text.find('.') == std::string::npos || text.back() != '0') << text;
        const float back = std::strtof(text.c_str(), nullptr);
        ASSERT_EQ(std::bit_cast<std::uint32_t>(back), std::bit_cast<std::uint32_t>(x)) << text;
    }
}

TEST(Numbers, AreShortAndHaveNoMinusZero) {
    const auto text_of = [](float x) {
        std::string text = "x ";
        append_number(text, x);
        return text;
    };
    EXPECT_EQ(text_of(0), "x 0");
    EXPECT_EQ(text_of(-0.0F), "x 0");
    EXPECT_EQ(text_of(1), "x 1");
    EXPECT_EQ(text_of(100), "x 100") << "zeros before the point stay";
    EXPECT_EQ(text_of(0.5F), "x 0.5");
    EXPECT_EQ(text_of(0.1F), "x 0.100000001");
    std::string text;
    append_decimals(text, -0.000001F, 5);
    text += ' ';
    append_decimals(text, 0.123456F, 5);
    EXPECT_EQ(text, "0 0.12346");
}

TEST(Numbers, NearOnesAreTheShortestWithinTheTolerance) {
    const auto text_of = [](double value, double tolerance) {
        std::string text;
        append_near(text, value, tolerance);
        return text;
    };
    EXPECT_EQ(text_of(0.123456, 1e-7), ".123456");
    EXPECT_EQ(text_of(0.123456, 1e-3), ".123");
    EXPECT_EQ(text_of(0.1996, 1e-3), ".2");
    EXPECT_EQ(text_of(-0.25, 1e-9), "-.25");
    EXPECT_EQ(text_of(4096, 1e-3), "4096");
    EXPECT_EQ(text_of(1234.5, 0.01), "1234.5");
    EXPECT_EQ(text_of(65504, 100), "65500") << "as long as 655e2";
    EXPECT_EQ(text_of(65504, 1000), "66e3");
    EXPECT_EQ(text_of(1.2e-12, 1e-14), "12e-13");
    EXPECT_EQ(text_of(-1e-9, 1e-8), "0");
    EXPECT_EQ(text_of(0, 1e-8), "0");
    for (const float x : hard_floats(200000)) {
        const auto value = static_cast<double>(x);
        const double tolerance = precision_of(value);
        const double read = std::strtod(text_of(value, tolerance).c_str(), nullptr);
        EXPECT_NEAR(read, value, tolerance * (1 + 1e-9)) << text_of(value, tolerance);
    }
}

TEST(Numbers, OneDigitRoundsInTheGivenDirection) {
    const auto text_of = [](double value, bool is_up) {
        std::string text;
        append_one_digit(text, value, is_up);
        return text;
    };
    EXPECT_EQ(text_of(8192, true), "9e3");
    EXPECT_EQ(text_of(8192, false), "0");
    EXPECT_EQ(text_of(-8192, true), "0");
    EXPECT_EQ(text_of(-8192, false), "-9e3");
    EXPECT_EQ(text_of(0.95, true), "1");
    EXPECT_EQ(text_of(0.5, true), ".5");
    EXPECT_EQ(text_of(0.5, false), "0");
    EXPECT_EQ(text_of(0, true), "0");
}

TEST(Numbers, LoseTheZeroBeforeThePoint) {
    const auto short_of = [](std::string text) {
        text.insert(0, "1 ");
        drop_zero_before_point(text, 2);
        return text.substr(2);
    };
    EXPECT_EQ(short_of("0.25"), ".25");
    EXPECT_EQ(short_of("-0.25"), "-.25");
    EXPECT_EQ(short_of("0"), "0");
    EXPECT_EQ(short_of("10.5"), "10.5");
    EXPECT_EQ(short_of("-1e-05"), "-1e-05");
    EXPECT_EQ(short_of(""), "");
}

}  // namespace
}  // namespace tonewright
