// SPDX-License-Identifier: Apache-2.0
#include "formula/formula.h"

#include <gtest/gtest.h>

#include <string>

#include "unit/formula/curve_formula.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const Expr kX = Expr::input(0);

TEST(Formula, PrintedTextReadsBackTheSame) {
    const char* const formulas[] = {
        "x",
        "-x",
        "a = !x\n(-x - a - a)",
        "-(x + 1)",
        "x - (k - x)",
        "x - (x + k)",
        "x/(k/x)",
        "x*(k*x)",
        "-0.5*x",
        "x - -2",
        "x < 2 ? x : -x",
        "(x < 2 ? x : k) + 1",
        "(x < k) < x",
        "(x < k) == (k < x)",
        "x == 2 ? x < 1 ? 1 : 2 : x ? 3 : 4",
        "x && k || !x",
        "pow(x, k) + exp(x)",
        "smoothstep(0.1, 0.7, x)",
        "mix(x, k, 0.3)",
        "a = x + 1\nb = a*a\nb/(b + a)",
        "sin(x) + cos(x) + atan2(x, 2) + floor(x) + abs(x) + sqrt(x) + log10(x)",
        "1e-300*x + 1e300 + 0.1"};
    const std::vector<std::string> inputs = {"x"};
    for (const char* formula : formulas) {
        const Expr e = parsed_formula(formula);
        const std::string printed = whole_formula(e, inputs);
        EXPECT_TRUE(same(parsed_formula(printed), e)) << formula << " as " << printed;
    }
    const Expr shared = sqrt(kX + 1);
    const FormulaText two = formula_text(std::array{shared + 1, shared * shared}, inputs);
    EXPECT_EQ(two.temporaries, "t1 = sqrt(x + 1)\n");
    EXPECT_EQ(two.values, (std::vector<std::string>{"t1 + 1", "t1*t1"}));
    EXPECT_THROW((void)formula_text(std::array{kX + Expr::uniform("x")}, inputs), Error);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
