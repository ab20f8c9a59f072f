// SPDX-License-Identifier: Apache-2.0
#include "base/half_value.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(HalfValue, EveryPatternReadsBack) {
    for (unsigned bits = 0; bits < 0x10000; ++bits) {
        const double value = half_value(bits);
        if (std::isnan(value)) continue;
        ASSERT_EQ(half_bits(value), bits);
    }
    EXPECT_TRUE(std::isnan(half_value(half_bits(std::numeric_limits<double>::quiet_NaN()))));
}

TEST(HalfValue, NearestWithTiesToEven) {
    EXPECT_EQ(half_bits(0.1), 0x2E66U);  // IEEE 754: 0.0999755859375
    EXPECT_EQ(half_bits(1 + 0x1p-11), 0x3C00U);
    EXPECT_EQ(half_bits(1 + 3 * 0x1p-11), 0x3C02U);
    EXPECT_EQ(half_bits(2 - 0x1p-12), 0x4000U);
    EXPECT_EQ(half_bits(0x1p-14 - 0x1p-26), 0x0400U);
    EXPECT_EQ(half_bits(0x1p-25), 0U);
    EXPECT_EQ(half_bits(65519.9), 0x7BFFU);
    EXPECT_EQ(half_bits(65520), 0x7C00U);
    EXPECT_EQ(half_bits(-1e30), 0xFC00U);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
