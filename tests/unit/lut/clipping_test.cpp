// SPDX-License-Identifier: Apache-2.0
#include "tonewright/lut.h"

#include <gtest/gtest.h>

#include <cmath>

#include "unit/lut/lut_cases.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Code value of 0.72 by IEC 61966-2-1.
const double kCodeAtTwoStops = 1.055 * std::pow(0.72, 1 / 2.4) - 0.055;

TEST(Clipping, SaysWhichStops) {
    // Shows light up to 1, that is 2.474 stops above 0.18.
    const auto clipping = [](const char* op, const char* encoding) {
        const LutRequest r = request_for(op, encoding);
        return measure_clipping(r, sample_lut(r));
    };
    const LutClipping two = clipping("clamp", "log2:-16:2");
    ASSERT_TRUE(two.above);
    EXPECT_NEAR(two.above->end, 2, 1e-12);
    EXPECT_NEAR(two.above->error, 1 - kCodeAtTwoStops, 1e-12);
    EXPECT_FALSE(two.below);
    // White stays white: there is no stop at which the two agree again.
    EXPECT_EQ(to_string(two), "above +2.00 stops from 0.18, without end, by up to 1.4e-01");
    EXPECT_EQ(to_string(clipping("clamp", "log2:-8:2")),
              "above +2.00 stops from 0.18, without end, by up to 1.4e-01; below -8.00 stops, down "
              "to black, by up to 9.1e-03");
    EXPECT_FALSE(clipping("clamp", "log2:-16:3").above);
    EXPECT_EQ(to_string(clipping("clamp", "log2:-16:3")), "");
    // 12.92 * 0.18 * 2^-8 is 9.08e-3: so much black is off.
    const LutClipping eight = clipping("clamp", "log2:-8:3");
    ASSERT_TRUE(eight.below);
    EXPECT_NEAR(eight.below->end, -8, 1e-12);
    EXPECT_NEAR(eight.below->error, 12.92 * 0.18 / 256, 1e-4);
    EXPECT_EQ(to_string(eight), "below -8.00 stops from 0.18, down to black, by up to 9.1e-03");
    // ACEScct goes to 0.
    EXPECT_FALSE(clipping("clamp", "acescct").below);
    // Never reaches its white: at 10.27 stops it has some hundredths to go.
    const LutClipping reinhard = clipping("reinhard", "acescct");
    ASSERT_TRUE(reinhard.above);
    EXPECT_GT(reinhard.above->last, 12);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
