// SPDX-License-Identifier: Apache-2.0
#include "shader/running_error.h"

#include <gtest/gtest.h>

#include <cmath>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const Expr kX = Expr::input(0);

Bounded exactly(double x) { return {{x, x}, {x, x}, 0}; }

TEST(RunningError, ContainsWhatFloatComputes) {
    // x + 1, x * x, x / 3 and a root, of floats: IEEE rounds each correctly, which Vulkan allows.
    const std::vector<Expr> formulas = {kX + 1, kX * kX, kX / 3, sqrt(kX), kX * kX - kX};
    const RunningError running(formulas);
    for (const float x : {0.1F, 0.7F, 3.3F, 1000.1F}) {
        const float third = 3;
        const float computed[] = {x + 1, x * x, x / third, std::sqrt(x), x * x - x};
        const std::vector<Bounded> bounds = running({exactly(static_cast<double>(x))});
        ASSERT_EQ(bounds.size(), formulas.size());
        for (std::size_t i = 0; i < formulas.size(); ++i) {
            const double exact = evaluate(formulas[i], static_cast<double>(x));
            const double got = static_cast<double>(computed[i]);
            EXPECT_LE(bounds[i].exact.lo, exact);
            EXPECT_GE(bounds[i].exact.hi, exact);
            EXPECT_LE(bounds[i].computed.lo, got) << i;
            EXPECT_GE(bounds[i].computed.hi, got) << i;
            EXPECT_GE(bounds[i].error, std::fabs(got - exact)) << i;
        }
        // One correctly rounded addition errs by half a unit of 2^-23: the bound is no empty
        // promise.
        EXPECT_LE(bounds[0].error, static_cast<double>(x + 1) * std::exp2(-22));
    }
}

TEST(RunningError, AnUncertainComparisonIsAChoice) {
    const RunningError running({select(less(kX, 1), 0, 5)});
    bool has_choice = false;
    const std::vector<Bounded> open = running({{{0.5, 1.5}, {0.5, 1.5}, 0.01}}, &has_choice);
    EXPECT_TRUE(has_choice);
    EXPECT_GE(open[0].error, 5) << "the difference of the branches";
    has_choice = false;
    EXPECT_LT(running({{{2, 3}, {2, 3}, 0.01}}, &has_choice)[0].error, 1);
    EXPECT_FALSE(has_choice);
}

TEST(RunningError, IntervalsGrowOnly) {
    EXPECT_EQ(magnitude({-3, 2}), 3);
    const Interval both = hull({-1, 0}, {2, 3});
    EXPECT_EQ(both.lo, -1);
    EXPECT_EQ(both.hi, 3);
    const Interval wide = widened({0.1, 0.2});
    EXPECT_LT(wide.lo, 0.1);
    EXPECT_GT(wide.hi, 0.2);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
