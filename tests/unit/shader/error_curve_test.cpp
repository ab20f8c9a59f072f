// SPDX-License-Identifier: Apache-2.0
#include "shader/error_curve.h"

#include <gtest/gtest.h>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const Expr kX = Expr::input(0);

TEST(ErrorCurve, CountsAnErrorWithTheSlopeOfTheWholeFunction) {
    // (x + 1000) - 1000 has slope 1: an error of 0.01 stays 0.01, although each operation adds
    // roundings of 1000. Exact operations add none.
    ErrorCurve curve((kX + 1000) - 1000, false);
    const Bounded got = curve({{1, 2}, {0.99, 2.01}, 0.01});
    EXPECT_NEAR(got.error, 0.01, 1e-5);
    EXPECT_LE(got.exact.lo, 1);
    EXPECT_GE(got.exact.hi, 2);
    // Rounded ones add half a unit of 1000 each: 2^-14, at least once.
    ErrorCurve rounded((kX + 1000) - 1000, true);
    EXPECT_GE(rounded({{1, 2}, {0.99, 2.01}, 0.01}).error, 0.01 + 3e-5);
}

TEST(ErrorCurve, IsABoundOfASteepFunction) {
    ErrorCurve curve(kX * kX, false);
    for (const double x : {0.5, 3.0, 100.0}) {
        const double error = 1e-3 * x;
        const Bounded got = curve({{x, x}, {x - error, x + error}, error});
        const double most = (x + error) * (x + error) - x * x;
        EXPECT_GE(got.error, most * (1 - 1e-9)) << x;
        EXPECT_LE(got.error, 2 * most) << "no more than the slope of a small piece";
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
