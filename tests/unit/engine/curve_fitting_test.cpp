// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>

#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(CurveFitting, ACostlyFunctionOfOneValueIsOneCurve) {
    // explain() prints the program. A multiplication and an addition cost less than a curve.
    const Expr x = Expr::input(0);
    const auto curves = [](const Expr& f) {
        const std::string text = explain({curve_stage(f)});
        return text.find(" = curve") != std::string::npos;
    };
    EXPECT_TRUE(curves(log2(pow(max(x, 1e-3), 0.7) + 1) / log2(pow(max(x, 1e-3), 0.3) + 2)));
    EXPECT_FALSE(curves(x * 0.5 + 0.25));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
