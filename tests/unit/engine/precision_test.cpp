// SPDX-License-Identifier: Apache-2.0
#include "engine/precision.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/tape.h"
#include "tonewright/expr.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(Sensitivity, IsTheDerivativeAtColorsOfAllMagnitudes) {
    const Expr r = Expr::input(0);
    const Tape tape({r * r, 3 * Expr::input(1), Expr::input(2) / 4});
    const Sensitivity measured = measure_sensitivity(tape.code(), tape.outputs());
    ASSERT_EQ(measured.value.size(), measured.sensitivity.size());
    std::array<double, 3> least = {1, 1, 1};
    std::array<double, 3> most{};
    std::array<bool, 3> has_negative{};
    for (std::size_t probe = 0; probe < measured.value[0].size(); ++probe) {
        for (std::size_t i = 0; i < tape.code().size(); ++i) {
            if (tape.code()[i].op != ExprOp::input) continue;
            const double x = measured.value[i][probe];
            const double size = std::fabs(x);
            // Relative to outputs above 1.
            const std::array<double, 3> expected = {2 * size / std::max(1.0, x * x),
                                                    3 / std::max(1.0, 3 * size),
                                                    0.25 / std::max(1.0, size / 4)};
            const auto c = static_cast<std::size_t>(tape.code()[i].input);
            ASSERT_NEAR(measured.sensitivity[i][probe], expected[c], 1e-12 * expected[c])
                << "channel " << c << " at " << x;
            if (size > 0) least[c] = std::min(least[c], size);
            most[c] = std::max(most[c], size);
            has_negative[c] = has_negative[c] || x < 0;
        }
    }
    // From where a picture is black to half floats' largest numbers: curves are fitted for these.
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_LT(least[c], 0x1p-16) << c;
        EXPECT_GT(most[c], 0x1p14) << c;
        EXPECT_TRUE(has_negative[c]) << c;
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
