// SPDX-License-Identifier: Apache-2.0
#include "engine/probe_block.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "base/random.h"
#include "engine/tape.h"
#include "tonewright/expr.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::vector<Vector3> random_colors(std::size_t count, double lo, double hi) {
    SampleRandom random(3);
    std::vector<Vector3> colors(count);
    for (Vector3& color : colors) {
        for (double& x : color)
            x = random.uniform(lo, hi);
    }
    return colors;
}

/// Every operation that has a derivative.
std::array<Expr, 3> all_operations() {
    const Expr r = Expr::input(0);
    const Expr g = Expr::input(1);
    const Expr b = Expr::input(2);
    return {r * g / b + pow(r, 2.5) - pow(g, b) + atan2(r, g),
            min(r, g) + 3 * max(g, b) + abs(r - b) * -g,
            sqrt(r) + exp2(g) + log2(b) + sin(r) + cos(g) + select(less(r, g), r * b, g)};
}

TEST(ProbeBlock, AdjointsAreDifferenceQuotients) {
    const std::array<Expr, 3> expressions = all_operations();
    const Tape tape(expressions);
    ProbeBlock block(tape.code(), tape.outputs(), false);
    std::vector<Vector3> colors = random_colors(200, 0.5, 2);
    // The quotients must not reach across a kink.
    constexpr double kStep = 1e-5;
    std::erase_if(colors, [](const Vector3& c) {
        return std::min({std::fabs(c[0] - c[1]), std::fabs(c[1] - c[2]), std::fabs(c[0] - c[2])}) <
               4 * kStep;
    });
    for (std::size_t p = 0; p < colors.size(); p += ProbeBlock::kLanes) {
        block.evaluate(&colors[p], std::min(ProbeBlock::kLanes, colors.size() - p));
        block.differentiate();
        for (std::size_t lane = 0; lane < block.size(); ++lane) {
            for (std::size_t i = 0; i < tape.code().size(); ++i) {
                if (tape.code()[i].op != ExprOp::input) continue;
                const auto channel = static_cast<std::size_t>(tape.code()[i].input);
                Vector3 above = colors[p + lane];
                Vector3 below = above;
                above[channel] += kStep;
                below[channel] -= kStep;
                for (std::size_t o = 0; o < 3; ++o) {
                    const double here = evaluate(expressions[o], colors[p + lane]);
                    const double quotient =
                        (evaluate(expressions[o], above) - evaluate(expressions[o], below)) /
                        (2 * kStep) / std::max(1.0, std::fabs(here));
                    // Third derivatives up to 400 (6 r g / b^4) times kStep^2 / 6, and the rounding
                    // of values up to 10 divided by kStep.
                    EXPECT_NEAR(block.adjoint(o, i, lane), quotient, 1e-8)
                        << "output " << o << ", channel " << channel;
                }
            }
        }
    }
}

TEST(ProbeBlock, ColorHasTheSameBitsBesideOthersAndAlone) {
    for (const char* name : {"agx_blender", "khronos_neutral", "aces_20"}) {
        const View view = make_view(resolve_operator(name, {}, ""), "lin_rec709", 0, "srgb");
        const Tape tape(compose(build_view(view)));
        ProbeBlock together(tape.code(), tape.outputs(), false);
        ProbeBlock alone(tape.code(), tape.outputs(), false);
        const std::vector<Vector3> colors = random_colors(ProbeBlock::kLanes, -0.5, 8);
        together.evaluate(colors.data(), colors.size());
        together.differentiate();
        for (std::size_t lane = 0; lane < colors.size(); ++lane) {
            alone.evaluate(&colors[lane], 1);
            alone.differentiate();
            for (std::size_t i = 0; i < tape.code().size(); ++i) {
                EXPECT_EQ(std::bit_cast<std::uint64_t>(together.value(i, lane)),
                          std::bit_cast<std::uint64_t>(alone.value(i, 0)));
                for (std::size_t o = 0; o < 3; ++o)
                    EXPECT_EQ(together.adjoint(o, i, lane), alone.adjoint(o, i, 0)) << name;
            }
            for (std::size_t o = 0; o < 3; ++o)
                EXPECT_EQ(alone.value(tape.outputs()[o], 0),
                          evaluate(compose(build_view(view))[o], colors[lane]));
        }
    }
}

TEST(ProbeBlock, PolesAreLeftOutOfAdjoints) {
    const Expr r = Expr::input(0);
    const Tape tape({sqrt(r), r, r});
    ProbeBlock block(tape.code(), tape.outputs(), true);
    const std::vector<Vector3> colors = {{0, 0, 0}, {0.25, 0, 0}};
    block.evaluate(colors.data(), colors.size());
    block.differentiate();
    const auto input = static_cast<std::size_t>(tape.outputs()[1]);
    EXPECT_TRUE(block.has_pole(0, input, 0));
    EXPECT_EQ(block.adjoint(0, input, 0), 0);
    EXPECT_FALSE(block.has_pole(0, input, 1));
    EXPECT_EQ(block.adjoint(0, input, 1), 1);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
