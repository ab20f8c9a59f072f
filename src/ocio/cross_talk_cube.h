// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The 3D LUT of a channel-mixing stage, between a shaper and srgb_decode().
struct CrossTalkCube {
    /// Scene-linear in [0, top] -> position in [0, 1] on each axis; of input 0.
    Expr shaper;
    std::vector<float> nodes;  // RGB triplets of unclipped sRGB code values, blue fastest
};

struct CrossTalkCubeOptions {
    int edge = 65;
    /// The 3D LUT is made for colors of these primaries and of Rec.709.
    Primaries primaries = kRec709;
    /// Fits the nodes for the least error between them, which takes seconds; otherwise samples
    /// them.
    bool is_fitted = false;
    /// @see cached_numbers
    std::string cache_folder = {};
};

/// End of the axes: the value at which the stage saturates, and at most `largest`.
/// @param behind  the clamp after the stage
[[nodiscard]] double cross_talk_top(const CrossTalkStage& stage, const ClampStage& behind,
                                    double largest, bool is_fitted);

/// The 3D LUT with axes to `top`. Caches the last ones, because views of one operator share them
/// across displays.
/// @param behind  clamp after the 3D LUT: nodes are free outside its interval
[[nodiscard]] std::shared_ptr<const CrossTalkCube> cross_talk_cube(
    const CrossTalkStage& stage, const ClampStage& behind, double top,
    const CrossTalkCubeOptions& options);

TONEWRIGHT_NAMESPACE_END
