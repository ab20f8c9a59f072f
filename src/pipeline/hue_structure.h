// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Structure of a channel-mixing stage that keeps hues and ends in the gamut of a display: matrices
/// and curves to axes, and the effect of the stage on hue, saturation and value of these axes. A 3D
/// LUT over them bends where the stage bends.
struct HueStructure {
    /// Scene-linear in [0, inf) -> three axes by matrices and curves; positive for all colors of
    /// the working primaries, and equal for neutrals.
    Pipeline to_axes;
    /// Axes -> result of the stage in the display's RGB.
    CrossTalkStage of_axes;
    /// Largest channel of the display.
    double peak = 1;
    /// Colors on the axes whose hues are bends of the stage.
    std::vector<Vector3> bends = {};
};

/// Declares the structure of a stage. The last 64 stages are kept.
/// @pre  structure.of_axes after structure.to_axes equals the stage, except for rounding.
void declare_hue_structure(const CrossTalkStage& stage, HueStructure structure);

/// Declared structure of a stage with the same expressions; null if there is none.
[[nodiscard]] TONEWRIGHT_API std::shared_ptr<const HueStructure> find_hue_structure(
    const CrossTalkStage& stage);

TONEWRIGHT_NAMESPACE_END
