// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// How a channel-mixing stage is made that keeps hues and ends in the gamut of a display: axes that
/// light reaches by matrices and curves, and what the stage does to hue, saturation and value of
/// these axes. A 3D LUT over them bends where the stage bends.
struct HueStructure {
    /// Light in [0, inf) -> three axes by matrices and curves; positive for all light of the
    /// working primaries, and equal to each other for neutrals.
    Pipeline to_axes;
    /// The axes -> what the stage makes of the light, in the display's RGB.
    CrossTalkStage of_axes;
    /// The largest channel that the display shows.
    double peak = 1;
    /// Colors on the axes at whose hue the stage bends.
    std::vector<Vector3> bends = {};
};

/// Remembers the structure of a stage. The last 64 stages are remembered.
/// @pre  structure.of_axes behind structure.to_axes equals the stage, but for rounding.
void declare_hue_structure(const CrossTalkStage& stage, HueStructure structure);

/// The structure that was declared for a stage with the same expressions; null where there is none.
[[nodiscard]] TONEWRIGHT_API std::shared_ptr<const HueStructure> find_hue_structure(
    const CrossTalkStage& stage);

TONEWRIGHT_NAMESPACE_END
