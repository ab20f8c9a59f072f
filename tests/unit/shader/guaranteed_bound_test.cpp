// SPDX-License-Identifier: Apache-2.0
#include "shader/guaranteed_bound.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/random.h"
#include "engine/tape.h"
#include "expr/scalar_ops.h"
#include "full_counts.h"
#include "shader/error_curve.h"
#include "tonewright/engine.h"
#include "tonewright/pipeline.h"
#include "tonewright/registry.h"
#include "tonewright/shader.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Signs = std::function<double(std::size_t step)>;

/// Runs the tape with an error in every operation that has one: the largest that Vulkan allows, of
/// this sign.
std::array<double, 3> run(const Tape& tape, const std::array<float, 3>& color, const Signs& sign) {
    std::vector<double> value(tape.code().size());
    for (std::size_t i = 0; i < value.size(); ++i) {
        const TapeInstruction& step = tape.code()[i];
        const double a = value[step.a];
        const double b = value[step.b];
        double exact = 0;
        if (step.op == ExprOp::input) {
            value[i] = static_cast<double>(color[static_cast<std::size_t>(step.input)]);
            continue;
        }
        if (step.op == ExprOp::constant) {
            value[i] = static_cast<double>(static_cast<float>(step.value));
            continue;
        }
        exact = step.op == ExprOp::grid ? (*step.grid)(step.input, a, b, value[step.c])
                                        : scalar_op(step.op, a, b, value[step.c], step.table);
        const double allowed = rounding_of(step.op, std::fabs(exact), {a, a}, {b, b}).vulkan;
        // Correctly rounded: a float stays what it is.
        const bool is_exact = (step.op == ExprOp::add || step.op == ExprOp::subtract ||
                               step.op == ExprOp::multiply) &&
                              static_cast<double>(static_cast<float>(exact)) == exact;
        value[i] = is_exact ? exact : exact + sign(i) * allowed;
        // A root's and a power's result is none of a negative.
        if (exact >= 0) value[i] = std::max(value[i], 0.0);
    }
    return {value[tape.outputs()[0]], value[tape.outputs()[1]], value[tape.outputs()[2]]};
}

std::array<double, 3> run_exactly(const ReferenceEngine& reference, const std::array<float, 3>& c) {
    return reference({double{c[0]}, double{c[1]}, double{c[2]}});
}

/// IEC 61966-2-1.
double srgb_of(double light) {
    const double x = std::max(light, 0.0);
    return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
}

double difference(double got, double right) {
    return std::fabs(srgb_of(got) - srgb_of(right)) / std::max(1.0, srgb_of(right));
}

ShaderRequest request_of(const OperatorVariant& variant) {
    ShaderRequest request;
    request.view =
        make_view(resolve_operator(variant.name, {}, variant.look), "lin_rec709", 0, "linear");
    return request;
}

// A processor that errs as much as it may, in every operation, must stay within the bound.
TEST(GuaranteedBound, HoldsForProcessorsThatErrAsMuchAsTheyMay) {
    SampleRandom random(7);
    int useful = 0;
    const std::vector<OperatorVariant> all = all_variants();
    for (std::size_t v = 0; v < all.size(); v += count_of(1U, 6U)) {
        const ShaderRequest request = request_of(all[v]);
        const double bound = measure_shader(request).guaranteed;
        if (!std::isfinite(bound)) continue;
        ++useful;
        const Pipeline pipeline = build_live_view(request.view, {});
        const Tape tape(compose(make_program(pipeline, {})));
        const ReferenceEngine reference(pipeline);
        double worst = 0;
        for (std::size_t i = 0; i < count_of(20'000U, 2'000U); ++i) {
            std::array<float, 3> color{};
            const bool is_gray = i % 3 == 0;
            for (float& x : color)
                x = static_cast<float>(std::exp2(random.uniform(-20, 16)));
            if (is_gray) color.fill(color[0]);
            if (i % 7 == 0) color[i % 3] = 0;
            const double up = i % 2 == 0 ? 1 : -1;
            const Signs all_one_way = [&](std::size_t) { return up; };
            const Signs any = [&](std::size_t) { return random.uniform(0, 1) < 0.5 ? -1.0 : 1.0; };
            const auto right = run_exactly(reference, color);
            for (const Signs& signs : {all_one_way, any}) {
                const auto got = run(tape, color, signs);
                for (std::size_t c = 0; c < 3; ++c)
                    worst = std::max(worst, difference(got[c], right[c]));
            }
        }
        // The series of 1 - 2^x may be 1e-8 off the formula.
        EXPECT_LE(worst, bound + 1e-8) << all[v].name << " " << all[v].look;
    }
    EXPECT_GE(useful, static_cast<int>(count_of(45U, 7U)));
}

Bounded at(double x, double error) { return {{x, x}, {x - error, x + error}, error}; }

TEST(GuaranteedBound, ACurveCountsAnErrorOfItsArgumentWithItsOwnSlope) {
    const Expr x = Expr::input();
    // 127 x^3 - 127 x^3 + x, whose operations are steep and cancel.
    ErrorCurve curve(x * x * x * 127 + x - x * x * x * 127, false);
    const double e = 1e-6;
    // Near 0.5 pieces are at most 2^-8 wide: slopes of 127 * 3 x^2 differ by 3 within one.
    EXPECT_LE(curve(at(0.5, e)).error, 5 * e);
    EXPECT_GE(curve(at(0.5, e)).error, e);
}

TEST(GuaranteedBound, AJumpCountsWhereRoundingMayCrossIt) {
    const Expr x = Expr::input();
    ErrorCurve step(select(less(x, 0.25), 1.0, 3.0), true);
    EXPECT_NEAR(step(at(0.25, 1e-7)).error, 2, 1e-6);
    EXPECT_EQ(step(at(0.2, 1e-7)).error, 0);
    // Without an error of the argument, and with a threshold that float has, both sides agree.
    EXPECT_EQ(step({{0.2, 0.3}, {0.2, 0.3}, 0}).error, 0);
    // 0.1 is not a float: what lies between it and the next one may go either way.
    ErrorCurve rounded(select(less(x, 0.1), 1.0, 3.0), true);
    EXPECT_NEAR(rounded(at(0.1, 0)).error, 2, 1e-6);
}

TEST(GuaranteedBound, ARootNearZeroIsBoundedByTheRootOfTheError) {
    ErrorCurve root(sqrt(max(Expr::input(), 0)), true);
    const double error = root({{0, 1e-12}, {-1e-6, 1e-6}, 1e-6}).error;
    EXPECT_LE(error, 1.01e-3);
    EXPECT_GE(error, 1e-3);
}

TEST(GuaranteedBound, SaysWhereTheErrorArises) {
    const ShaderErrors errors = measure_shader(request_of({.name = "khronos_neutral", .look = ""}));
    EXPECT_TRUE(std::isinf(errors.guaranteed));
    EXPECT_EQ(errors.arises_in, "hexcone");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
