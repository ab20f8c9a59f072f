// SPDX-License-Identifier: Apache-2.0
#include "shader/float_form.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shader/float_run.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(FloatForm, GuardsOnlyWhatCanGoWrong) {
    const Expr x = Expr::input();
    const auto form = [&](const Expr& e, const Interval& in) {
        return to_string(FloatForm({in}, {})(e));
    };
    EXPECT_EQ(form(log2(x), {0.1, 1}), "log2(x)");
    EXPECT_EQ(form(sqrt(x), {0, 1}), "sqrt(x)");
    EXPECT_EQ(form(sqrt(x), {-1, 1}), "sqrt(max(x, 0))");
    EXPECT_EQ(form(1 / (x + 1), {0, 1}), "1/(x + 1)");
    EXPECT_EQ(form(1 / x, {0, 1}), "1/max(x, 1e-30)");
    EXPECT_EQ(form(1 / x, {-1, 1}), "1/select(less(abs(x), 1e-30), 1e-30, x)");
    EXPECT_EQ(form(pow(x, 2), {-1, 1}), "x*x");
    EXPECT_EQ(form(pow(x, 0.5), {0, 1}), "sqrt(x)");
    EXPECT_EQ(form(pow(x, 2.2), {0.5, 1}), "pow(x, 2.2)");
    EXPECT_EQ(form(pow(x, 2.2), {0, 1}), "pow(max(x, 1.1754943508222875e-38), 2.2)");
    // The smallest float to the power of 0.01 is 0.42: 0 has to be told apart.
    EXPECT_EQ(form(pow(x, 0.01), {0, 1}),
              "select(less(0, x), pow(max(x, 1.1754943508222875e-38), 0.01), 0)");
}

// 1 - e^-x of small x, which float rounds away as it is written.
TEST(FloatForm, OneMinusAnExponentialKeepsItsDigits) {
    const Expr x = Expr::input();
    const Expr f = FloatForm({{0, 4}}, {})(1 - exp(-x));
    ShaderProgram program;
    program.scalars.push_back({"f", f});
    program.steps.emplace_back(ScalarStep{0});
    const FloatRun run(program);
    for (const float at : {0.0F, 1e-8F, 1e-4F, 0.01F, 0.1F, 0.24F, 0.26F, 1.0F, 4.0F}) {
        std::array<float, 3> color = {at, at, at};
        run.run_rgb(color.data(), color.data(), 1);
        const double right = -std::expm1(-double{at});
        EXPECT_NEAR(double{color[0]}, right, 4e-7 * right) << at;  // a few roundings
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
