// SPDX-License-Identifier: Apache-2.0
#include "shader/body.h"

#include <gtest/gtest.h>

#include <string>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

FunctionBody body() {
    return {facts_of(ShaderLanguage::glsl), {"r", "g", "b"}, {"r", "g", "b"}, {}, {}};
}

TEST(FunctionBody, PrintsWithFewestBrackets) {
    const Expr r = Expr::input(0);
    const Expr g = Expr::input(1);
    const auto text = [](const Expr& e) {
        FunctionBody out = body();
        out.count(e);
        return out.value(e);
    };
    EXPECT_EQ(text((r + g) * 2), "(r + g) * 2.0");
    EXPECT_EQ(text(r - (g - r)), "r - (g - r)");
    EXPECT_EQ(text(r / (r + 1)), "r / (r + 1.0)");
    EXPECT_EQ(text(max(r, 0)), "max(r, 0.0)");
}

TEST(FunctionBody, WhatIsReadTwiceBecomesAVariable) {
    const Expr sum = Expr::input(0) + Expr::input(1);
    FunctionBody out = body();
    const Expr e = sum * sum;
    out.count(e);
    const std::string value = out.value(e);
    EXPECT_NE(out.lines().find("= r + g;"), std::string::npos) << out.lines();
    EXPECT_EQ(out.lines().find("r + g", out.lines().find("r + g") + 1), std::string::npos)
        << "once";
    EXPECT_EQ(value.find("r + g"), std::string::npos) << value;
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
