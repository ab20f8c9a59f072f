// SPDX-License-Identifier: Apache-2.0
#include "ocio/lower.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "measure/sample_set.h"
#include "ocio/gpu.h"
#include "ocio/transforms.h"
#include "tonewright/engine.h"
#include "tonewright/ocio.h"
#include "tonewright/registry.h"
#include "unit/ocio/lowered_forms.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(LowerMap3, IsAShaperAndACube) {
    const Pipeline pipeline =
        build_view(make_view(resolve_operator("reinhard_jodie"), "lin_rec709", 0, "srgb"));
    const Lowered lowered = lower_to_ocio(pipeline);
    EXPECT_FALSE(lowered.is_exact);
    const Types types = types_of(lowered);
    EXPECT_EQ(std::count(types.begin(), types.end(), kLut3D), 1) << lowered.summary;
    for (const LoweredOp& op : lowered.ops) {
        const auto cube = OCIO_DYNAMIC_POINTER_CAST<OCIO::Lut3DTransform>(to_ocio(op));
        if (!cube) continue;
        EXPECT_EQ(cube->getGridSize(), 65U);
        EXPECT_EQ(cube->getInterpolation(), OCIO::INTERP_TETRAHEDRAL);
    }
    // 65^3 of a smooth operator: one code of 10 bits.
    expect_close(pipeline, positive_colors(), 1.0 / 1023, 1.0 / 1023);
    // 4 times the nodes, some 16 times less error: a cube of 17 must be clearly worse.
    const auto worst = [&](int edge) {
        LowerOptions options;
        options.cube_edge = edge;
        const std::vector<float> in = positive_colors();
        const std::vector<double> truth = reference(pipeline, in);
        std::vector<float> out(in.size());
        OcioCpu(make_processor(lower_to_ocio(pipeline, options).ops))
            .run_rgb(in.data(), out.data(), in.size() / 3);
        double error = 0;
        for (std::size_t i = 0; i < in.size(); ++i)
            error = std::max(error, std::fabs(static_cast<double>(out[i]) - truth[i]));
        return error;
    };
    EXPECT_GT(worst(17), 4 * worst(65)) << "the edge is read";
}

TEST(LowerMap3, AxesAreNotSwapped) {
    // Six saturated colors through a map that treats no two channels alike.
    const Expr r = Expr::input(0);
    const Expr g = Expr::input(1);
    const Expr b = Expr::input(2);
    const CrossTalkStage map = {{r / (1 + r + g), g / (1 + g + 0.5 * b), b / (1 + b + 0.25 * r)}};
    const Pipeline pipeline = {kPositive, map, kSdr, srgb()};
    expect_close(pipeline,
                 {1, 0.1F, 0.3F, 0.1F, 1, 0.3F, 0.1F, 0.3F, 1, 3, 2, 0.5F, 0.5F, 3, 2, 2, 0.5F, 3},
                 1.0 / 1023, 1.0 / 1023);
}

TEST(LowerMap3, SaysWhenACubeLosesNegatives) {
    const Expr r = Expr::input(0);
    const CrossTalkStage map = {{r, r, r}};
    EXPECT_TRUE(lower_to_ocio({map}).loses_negatives);
    EXPECT_TRUE(
        lower_to_ocio({kPositive, MatrixStage{rgb_to_rgb(kRec2020, kRec709)}, map}).loses_negatives)
        << "a matrix may make negatives again";
    EXPECT_TRUE(lower_to_ocio({ClampStage{-kInfinity, 1}, map}).loses_negatives);
    EXPECT_FALSE(lower_to_ocio({kPositive, map}).loses_negatives);
}

TEST(LowerMap3, LightAboveThePeakIsKeptOrRefused) {
    // The output of a map may be above 1, as with `linear` output or for HDR displays.
    std::array<Expr, 3> f = {Expr::input(0), Expr::input(1), Expr::input(2)};
    for (Expr& c : f)
        c = 12 * c / (1 + c);
    const Pipeline pipeline = {kPositive, CrossTalkStage{f}};
    const std::vector<float> in = {0.25F, 0.25F, 0.25F, 1, 1, 1, 3, 3, 3, 9, 0.5F, 0.1F};
    try {
        (void)lower_to_ocio(pipeline);
    } catch (const Error&) {
        return;
    }
    // Half a percent of the largest: five codes of ten bits.
    expect_close(pipeline, in, 0.005 * 12, 0.005 * 12);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
