// SPDX-License-Identifier: Apache-2.0
#include "shader/program.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(ShaderProgram, ComputesThePipeline) {
    // A curve, a matrix, a norm, branches, a grid.
    for (const char* name :
         {"hable", "aces_hill", "reinhard:luminance", "khronos_neutral", "agx_blender"}) {
        const Pipeline pipeline =
            build_view(make_view(resolve_operator(name), "lin_rec709", 0, "linear"));
        const std::array<Expr, 3> program = compose(make_program(pipeline, {}));
        const std::array<Expr, 3> reference = compose(pipeline);
        for (const std::array<double, 3>& rgb : std::vector<std::array<double, 3>>{
                 {0, 0, 0}, {0.18, 0.18, 0.18}, {4, 0.5, 0.01}, {-0.2, 1, 0.3}, {1000, 3, 0}}) {
            for (std::size_t c = 0; c < 3; ++c) {
                const double wanted = evaluate(reference[c], rgb);
                // Forms for float (a guard, a series) differ in the last digits of double.
                EXPECT_NEAR(evaluate(program[c], rgb), wanted,
                            1e-7 * std::max(1.0, std::fabs(wanted)))
                    << name;
            }
        }
    }
}

TEST(ShaderProgram, LimitsItsInput) {
    const ShaderProgram program = make_program({}, {});
    ASSERT_FALSE(program.steps.empty());
    const std::array<Expr, 3> f = compose(program);
    EXPECT_EQ(evaluate(f[0], std::array{1e30, 0.0, 0.0}), 65504) << "the largest half float";
    EXPECT_EQ(evaluate(f[1], std::array{0.0, -1e30, 0.0}), -65504);
    EXPECT_EQ(evaluate(f[2], std::array{0.0, 0.0, 0.25}), 0.25);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
