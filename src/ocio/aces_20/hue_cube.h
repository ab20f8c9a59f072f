// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pipeline/hue_structure.h"
#include "tonewright/color.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Entries at equal distances over [0, 1] of three channels, entry by entry.
using Table3 = std::vector<float>;

/// out = m in + offset.
struct AffineStep {
    Matrix3 m;
    Vector3 offset;
};

/// A 3D LUT of a channel-mixing stage over hue, saturation and value of the axes of its structure,
/// and the stages before and after it.
///
/// Colors on the display's hull bend sharply at its cusp. Every hue has its cusp at a different
/// value, so the third axis of the LUT is the value minus that of the cusp: all cusps are at one
/// node, and the nodes are densest there. The nodes of the hue axis are at the hues where the stage
/// bends.
///
/// The outputs of the LUT are exact where a display channel is 0: two ratios, which are linear in
/// display-linear, and the sum of the channels as a code.
struct HueCube {
    /// Rounding of the nodes: a code is steep near 0.
    static constexpr double kUnit = 5e-5;

    /// Axes -> axes whose value is in [0, 1].
    double gain = 1;
    // For hue, saturation and value, in this order:
    Table3 spread;  // hue -> a monotone sum of hue and the cusp's value; value -> stops
    AffineStep less_sum;
    Table3 back;  // the sum -> hue
    AffineStep plus_hue;
    Table3 place;
    int edge = 0;
    std::vector<float> nodes;  // RGB triplets in [0, 1], blue fastest
    /// The third channel, a code -> light.
    Table3 light;
    /// -> (x, y, Y) of X = R/3, Y = (R + G + B)/3, Z = B/3.
    AffineStep ratios;
    /// (X, Y, Z) -> the display's RGB.
    Matrix3 to_rgb;
};

struct HueCubeOptions {
    int edge = 65;
    /// In scene-linear light.
    Primaries primaries = kRec709;
    /// Samples for each node.
    double samples_per_node = 8;
    int rounds = 3;
    unsigned thread_count = 0;
    /// @see cached_numbers
    std::string cache_folder = {};
};

/// @param top  limit of every channel: the stage saturates there
[[nodiscard]] HueCube fit_hue_cube(const HueStructure& structure, double top,
                                   const HueCubeOptions& options);

/// fit_hue_cube() for a stage that declares the structure. Caches the last ones.
/// @param primaries     of the working space
/// @param cache_folder  @see cached_numbers
[[nodiscard]] std::shared_ptr<const HueCube> hue_cube(const CrossTalkStage& stage,
                                                      const HueStructure& structure, double top,
                                                      const Primaries& primaries,
                                                      const std::string& cache_folder);

TONEWRIGHT_NAMESPACE_END
