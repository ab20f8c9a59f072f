// SPDX-License-Identifier: Apache-2.0
#include "tasks/eval.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "tonewright/error.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

EvalRequest request_of(const std::string& op, EvalEngine engine = EvalEngine::reference) {
    return {.view = make_view(resolve_operator(op), "lin_rec709", 0, "linear"), .engine = engine};
}

using Colors = std::array<double, 6>;

Colors run(const ColorMap& map, const Colors& in) {
    Colors out{};
    map(in.data(), out.data(), 2);
    return out;
}

TEST(EvalTask, EachEngineComputesTheOperator) {
    const Colors in = {1, 1, 1, 0.25, 0.25, 0.25};
    for (const EvalEngine engine : {EvalEngine::reference, EvalEngine::simd, EvalEngine::ocio}) {
        const Colors out = run(color_map(request_of("reinhard", engine)), in);
        // L/(1 + L). OpenColorIO has a table of floats.
        const double tolerance = engine == EvalEngine::reference ? 1e-15 : 1e-5;
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_NEAR(out[i], 0.5, tolerance);
            EXPECT_NEAR(out[3 + i], 0.2, tolerance);
        }
    }
}

TEST(EvalTask, AnInverseGivesTheScene) {
    EvalRequest request = request_of("reinhard");
    request.is_inverse = true;
    const Colors out = run(color_map(request), {0.5, 0.5, 0.5, 0.2, 0.2, 0.2});
    EXPECT_NEAR(out[0], 1, 1e-12);
    EXPECT_NEAR(out[3], 0.25, 1e-12);
    request.view = request_of("false_color").view;
    EXPECT_THROW((void)color_map(request), Error);
}

TEST(EvalTask, TheStepsAreText) {
    const std::string steps = explain(request_of("reinhard"));
    EXPECT_TRUE(steps.starts_with("Target ")) << steps;
    EXPECT_NE(steps.find(" = divide "), std::string::npos) << "of L/(1 + L)\n" << steps;
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
