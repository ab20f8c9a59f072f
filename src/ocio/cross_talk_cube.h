// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "lut/hue_cube.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The 3D LUT of a channel-mixing stage, between a shaper and srgb_decode().
struct CrossTalkCube {
    /// Light in [0, top] -> place in [0, 1] on each axis; of input 0.
    Expr shaper;
    std::vector<float> nodes;  // RGB triplets of unclipped sRGB code values, blue fastest
};

struct CrossTalkCubeOptions {
    int edge = 65;
    /// The colors that the cube is made for are of these primaries and of Rec.709.
    Primaries primaries = kRec709;
    /// The nodes are fitted for the least error between them, which takes seconds; else sampled.
    bool is_fitted = false;
};

/// Where the cube's axes end: the light that the stage saturates at, and at most `largest`.
/// @param behind  what limits the result of the stage
[[nodiscard]] double cross_talk_top(const CrossTalkStage& stage, const ClampStage& behind,
                                    double largest, bool is_fitted);

/// The cube with axes to `top`. Cubes that were asked for last are kept: views of one operator for
/// several displays have the same.
/// @param behind  outside of its interval the nodes may hold anything
[[nodiscard]] std::shared_ptr<const CrossTalkCube> cross_talk_cube(
    const CrossTalkStage& stage, const ClampStage& behind, double top,
    const CrossTalkCubeOptions& options);

/// The 3D LUT of a stage that is declared in axes of hues. LUTs that were asked for last are kept.
/// @param primaries  of the light
[[nodiscard]] std::shared_ptr<const HueCube> hue_cube(const CrossTalkStage& stage,
                                                      const HueStructure& structure, double top,
                                                      const Primaries& primaries);

TONEWRIGHT_NAMESPACE_END
