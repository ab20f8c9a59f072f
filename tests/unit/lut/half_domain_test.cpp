// SPDX-License-Identifier: Apache-2.0
#include "lut/half_domain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/atomic_file.h"
#include "base/random.h"
#include "tonewright/engine.h"
#include "tonewright/lut.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const Expr kX = Expr::input();
constexpr unsigned kMinusZero = 0x8000;
constexpr unsigned kLargestHalf = 0x7BFF;
constexpr unsigned kHalfInfinity = 0x7C00;

TEST(HalfDomain, ValuesAreIeee754Binary16) {
    EXPECT_EQ(half_value(0x0000), 0);
    EXPECT_FALSE(std::signbit(half_value(0x0000)));
    EXPECT_EQ(half_value(kMinusZero), 0);
    EXPECT_TRUE(std::signbit(half_value(kMinusZero)));
    EXPECT_EQ(half_value(0x0001), 0x1p-24) << "smallest subnormal";
    EXPECT_EQ(half_value(0x03FF), 1023 * 0x1p-24) << "largest subnormal";
    EXPECT_EQ(half_value(0x0400), 0x1p-14) << "smallest normal";
    EXPECT_EQ(half_value(0x3555), 0.333251953125);
    EXPECT_EQ(half_value(0x3BFF), 1 - 0x1p-11);
    EXPECT_EQ(half_value(0x3C00), 1);
    EXPECT_EQ(half_value(0x3C01), 1 + 0x1p-10);
    EXPECT_EQ(half_value(0xC000), -2);
    EXPECT_EQ(half_value(kLargestHalf), 65504);
    EXPECT_EQ(half_value(kHalfInfinity), kInfinity);
    EXPECT_EQ(half_value(0xFC00), -kInfinity);
    EXPECT_TRUE(std::isnan(half_value(0x7C01)));
    EXPECT_TRUE(std::isnan(half_value(0xFFFF)));
    for (unsigned bits = 0; bits < kHalfInfinity; ++bits) {
        ASSERT_LT(half_value(bits), half_value(bits + 1));
        ASSERT_EQ(half_value(bits | kMinusZero), -half_value(bits));
    }
}

TEST(HalfDomain, SamplesAreInTheOrderOfTheBits) {
    const std::vector<float> table = sample_half_domain(2 * kX + 1, -kHalfMax, kHalfMax);
    ASSERT_EQ(table.size(), 65536U);
    for (unsigned bits = 0; bits < 65536; ++bits) {
        const unsigned magnitude = bits & 0x7FFF;
        if (magnitude > kLargestHalf) continue;
        ASSERT_EQ(table[bits], static_cast<float>(2 * half_value(bits) + 1)) << bits;
    }
}

TEST(HalfDomain, SpecialEntriesHaveTheirRule) {
    // 1/(x + 2) would tell a wrong entry from a right one everywhere; atan2 tells -0 from +0.
    const Expr f = atan2(kX, -1) + kX / 70000;
    ASSERT_NE(evaluate(f, 0.0), evaluate(f, -0.0)) << "the case is one";
    const std::vector<float> table = sample_half_domain(f, -kHalfMax, kHalfMax);
    EXPECT_EQ(table[kMinusZero], table[0]) << "OCIO's GPU path reads +0 there";
    EXPECT_EQ(table[0], static_cast<float>(evaluate(f, 0.0)));
    for (unsigned bits = 0; bits < 65536; ++bits) {
        const float expected = static_cast<float>(std::isnan(half_value(bits))
                                                      ? evaluate(f, 0.0)
                                                      : evaluate(f, sanitize(half_value(bits))));
        if (bits == kMinusZero) continue;
        ASSERT_EQ(table[bits], expected) << bits << ", " << half_value(bits);
    }
    EXPECT_EQ(table[kHalfInfinity], table[kLargestHalf]);
    EXPECT_EQ(table[kHalfInfinity | kMinusZero], table[kLargestHalf | kMinusZero]);
}

/// A table as its readers see it.
Lut half_lut(std::vector<float> values) {
    Lut lut;
    lut.dimension = 1;
    lut.size = 65536;
    lut.channels = 1;
    lut.is_half_domain = true;
    lut.values = std::move(values);
    return lut;
}

TEST(HalfDomain, HoldsItsEndsWithoutAKinkInside) {
    // Both ends lie between two half floats. A straight line is reproduced by interpolating between
    // any two entries, so inside the interval every error would be the ends' doing.
    constexpr double kLo = 0.0123456;
    constexpr double kHi = 16.3;
    const Lut lut = half_lut(sample_half_domain(0.25 * kX - 1, kLo, kHi));
    for (int i = 0; i <= 100000; ++i) {
        const double x = kLo + (kHi - kLo) * i / 100000;
        // Values of up to 3 in float.
        ASSERT_NEAR(interpolate(lut, {x, x, x})[0], 0.25 * x - 1, 3 * 0x1p-24) << x;
    }
    // Beyond the next half float the end's value holds.
    const auto at = [&](double x) { return interpolate(lut, {x, x, x})[0]; };
    for (const double x : {17.0, 1000.0, 65504.0, 1e30})
        EXPECT_NEAR(at(x), 0.25 * kHi - 1, 3 * 0x1p-24) << x;
    for (const double x : {0.0123, 0.001, 0.0, -0.0, -3.0, -65504.0})
        EXPECT_NEAR(at(x), 0.25 * kLo - 1, 3 * 0x1p-24) << x;
    EXPECT_EQ(lut.values[0x7E00], lut.values[0]) << "NaN";
}

TEST(HalfDomain, SmoothCurvesLoseNothingAtAShapersEnds) {
    // AgX's log2 between its ends: error of a chord between neighboring halves, h^2/8 f'' with
    // h = x 2^-10 and f'' = 1/(ln 2 x^2), is 1.7e-7; and float rounding of values up to 12.5.
    const double lo = std::exp2(-12.47393);
    const double hi = std::exp2(4.026069);
    const Lut lut = half_lut(sample_half_domain(log2(kX), lo, hi));
    for (int i = 0; i <= 100000; ++i) {
        const double x = lo * std::pow(hi / lo, i / 100000.0);
        ASSERT_NEAR(interpolate(lut, {x, x, x})[0], std::log2(x), 1.8e-7 + 12.5 * 0x1p-24) << x;
    }
}

TEST(HalfDomain, EntriesBeyondTheEndsStayFinite) {
    // The entry below this lower end is 0, where log2 has no value.
    for (const float y : sample_half_domain(log2(kX), 0x1p-25, kHalfMax))
        ASSERT_TRUE(std::isfinite(y));
    for (const float y : sample_half_domain(sqrt(kX), 0, kHalfMax))
        ASSERT_TRUE(std::isfinite(y));
    for (const float y : sample_half_domain(1 / kX, 1, 2))
        ASSERT_TRUE(y >= 0.49F && y <= 1.01F);
}

TEST(HalfDomain, InterpolationIsExactAtHalvesAndStraightBetween) {
    const Lut lut = half_lut(sample_half_domain(kX * kX, -kHalfMax, kHalfMax));
    for (unsigned bits = 0; bits <= kLargestHalf; bits += 7) {
        const double x = half_value(bits);
        ASSERT_EQ(interpolate(lut, {x, -x, 0})[0], static_cast<double>(static_cast<float>(x * x)));
        ASSERT_EQ(interpolate(lut, {x, -x, 0})[1], static_cast<double>(static_cast<float>(x * x)));
    }
    // Half way from 1 to its neighbor: (1 + (1 + 2^-10)^2)/2.
    const double x = 1 + 0x1p-11;
    EXPECT_EQ(interpolate(lut, {x, x, x})[2], (1 + (1 + 0x1p-10) * (1 + 0x1p-10)) / 2);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(interpolate(lut, {nan, kInfinity, -kInfinity}), interpolate(lut, {0, 65504, -65504}));
}

TEST(HalfDomain, UnusedEntriesMayDiffer) {
    const std::vector<float> table = sample_half_domain(kX * 2, 0, 1);
    const std::vector<signed char> slack = unused_entries(table, 0, 1);
    const unsigned one = 0x3C00;
    EXPECT_EQ(slack[0], 0);
    EXPECT_EQ(slack[0x8000], 0) << "-0";
    EXPECT_EQ(slack[0x8001], 0) << "interpolated with";
    EXPECT_EQ(slack[one + 1], 0) << "interpolated with";
    EXPECT_EQ(slack[one + 2], 1) << "larger, since the table rises";
    EXPECT_EQ(slack[0x8002], -1);
    const std::vector<signed char> all = unused_entries(table, -kHalfMax, kHalfMax);
    EXPECT_TRUE(std::all_of(all.begin(), all.end(), [](signed char s) { return s == 0; }));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
