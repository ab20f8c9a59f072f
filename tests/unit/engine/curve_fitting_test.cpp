// SPDX-License-Identifier: Apache-2.0
#include "engine/curve_fitting.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const Expr kX = Expr::input(0);

/// Two powers and two logarithms of one value.
Expr costly(const Expr& x) {
    return log2(pow(max(x, 1e-3), 0.7) + 1) / log2(pow(max(x, 1e-3), 0.3) + 2);
}

/// Code with its curves.
struct FittedCode {
    explicit FittedCode(const std::array<Expr, 3>& f) : tape(f) { refit(); }

    /// Fits again, like the compiler after it has rejected curves.
    void refit() {
        code = tape.code();
        outputs = tape.outputs();
        fit_curves(code, outputs, measure_sensitivity(code, outputs), cache, CurveForm::segments);
    }
    [[nodiscard]] std::vector<const CompiledCurve*> curves() const {
        std::vector<const CompiledCurve*> all;
        for (const TapeInstruction& step : code) {
            if (step.curve) all.push_back(step.curve);
        }
        return all;
    }

    Tape tape;
    std::vector<TapeInstruction> code;
    std::array<std::uint32_t, 3> outputs{};
    CurveCache cache;
};

TEST(CurveFitting, ACostlyFunctionOfOneValueIsOneCurve) {
    // explain() prints the program. A multiplication and an addition cost less than a curve.
    const auto curves = [](const Expr& f) {
        const std::string text = explain({curve_stage(f)});
        return text.find(" = curve") != std::string::npos;
    };
    EXPECT_TRUE(curves(costly(kX)));
    EXPECT_FALSE(curves(kX * 0.5 + 0.25));
}

TEST(CurveFitting, TheCurveReplacesAllStepsAndComputesTheSame) {
    const FittedCode fitted({costly(kX), kX * 0.5 + 0.25, kX});
    ASSERT_EQ(fitted.curves().size(), 1U);
    const TapeInstruction& curve = fitted.code[fitted.outputs[0]];
    EXPECT_EQ(curve.op, ExprOp::lookup);
    EXPECT_EQ(fitted.code[curve.a].op, ExprOp::input);
    EXPECT_EQ(fitted.outputs[2], curve.a);
    for (const TapeInstruction& step : fitted.code)
        EXPECT_TRUE(step.op != ExprOp::power && step.op != ExprOp::log2) << "no one reads it";
    EXPECT_EQ(fitted.code[fitted.outputs[1]].op, ExprOp::add);
    // 3 half units of a float, or what adds at most 2^-26 to the output.
    for (double x = 1e-4; x < 60000; x *= 1.07) {
        const double y = evaluate(costly(kX), static_cast<float>(x));
        EXPECT_NEAR((*curve.curve)(static_cast<float>(x)), y, 3.1 * 0x1p-24 * std::fabs(y)) << x;
    }
}

TEST(CurveFitting, ChannelsThatAreTreatedAlikeShareACurve) {
    const FittedCode fitted(
        {costly(Expr::input(0)), costly(Expr::input(1)), costly(Expr::input(2))});
    const std::vector<const CompiledCurve*> curves = fitted.curves();
    ASSERT_EQ(curves.size(), 3U);
    EXPECT_EQ(curves[0], curves[1]);
    EXPECT_EQ(curves[0], curves[2]);
    EXPECT_EQ(fitted.cache.size(), 1U);
}

TEST(CurveFitting, ACurveEndsWhereChannelsMeet) {
    const FittedCode fitted({costly(Expr::input(0)) * costly(Expr::input(1)), 0, 0});
    EXPECT_EQ(fitted.curves().size(), 2U);
    const TapeInstruction& product = fitted.code[fitted.outputs[0]];
    ASSERT_EQ(product.op, ExprOp::multiply);
    EXPECT_NE(fitted.code[product.a].curve, nullptr);
    EXPECT_NE(fitted.code[product.b].curve, nullptr);
    // The function of the product is a function of one value again.
    const FittedCode root({costly(Expr::input(0) * Expr::input(1)), 0, 0});
    ASSERT_EQ(root.curves().size(), 1U);
    EXPECT_EQ(root.code[root.code[root.outputs[0]].a].op, ExprOp::multiply);
}

TEST(CurveFitting, ARejectedCurveIsPreciseNextTimeAndThenThereIsNone) {
    FittedCode fitted({costly(kX), 0, 0});
    ASSERT_EQ(fitted.curves().size(), 1U);
    EXPECT_FALSE(fitted.curves()[0]->is_precise);
    const std::size_t count = fitted.cache.size();

    const CompiledCurve other;
    reject_curve(fitted.cache, &other);
    fitted.refit();
    ASSERT_EQ(fitted.curves().size(), 1U);
    EXPECT_FALSE(fitted.curves()[0]->is_precise) << "another curve is rejected";

    reject_curve(fitted.cache, fitted.curves()[0]);
    fitted.refit();
    ASSERT_EQ(fitted.curves().size(), 1U);
    EXPECT_TRUE(fitted.curves()[0]->is_precise);
    EXPECT_EQ(fitted.cache.size(), count);

    reject_curve(fitted.cache, fitted.curves()[0]);
    fitted.refit();
    const TapeInstruction& quotient = fitted.code[fitted.outputs[0]];
    EXPECT_EQ(quotient.curve, nullptr) << "its parts may be curves";
    EXPECT_EQ(quotient.op, ExprOp::divide);
    EXPECT_EQ(std::count_if(fitted.cache.begin(), fitted.cache.end(),
                            [](const auto& entry) { return entry.second.is_rejected; }),
              1);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
