// SPDX-License-Identifier: Apache-2.0
#include "tonewright/expr.h"

#include <gtest/gtest.h>

#include "base/format_number.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const Expr kX = Expr::input(0);
const Expr kY = Expr::input(1);

TEST(Expr, PrintsExactlyAndWithFewestBrackets) {
    EXPECT_EQ(to_string(kX * (kX + 1) / 3), "x*(x + 1)/3");
    EXPECT_EQ(to_string(kX - (kX - 1)), "x - (x - 1)");
    EXPECT_EQ(to_string(kX / (kX / 0.1)), "x/(x/0.1)");
    EXPECT_EQ(to_string(kX + (1 - kX)), "x + (1 - x)") << "a+(b-c) rounds differently from a+b-c";
    EXPECT_EQ(to_string(-(kX + 1)), "-(x + 1)");
    EXPECT_EQ(to_string(pow(max(kX, 0), 1 / 2.4)), "pow(max(x, 0), 0.4166666666666667)");
    EXPECT_EQ(to_string(kX * kY), "r*g");
    EXPECT_EQ(to_string(kX * -2), "x*-2");
    EXPECT_EQ(to_string(kX - -2), "x - -2");
    EXPECT_EQ(shortest(0.1), "0.1");
    EXPECT_EQ(shortest(1.0 / 3), "0.3333333333333333");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
