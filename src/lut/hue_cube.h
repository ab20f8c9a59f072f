// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
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
/// and what stands before and behind it.
///
/// A color that the display's hull limits bends sharply where the hull has its cusp. The cusp is at
/// another value for every hue, so the third axis of the LUT is the value less the cusp's: the
/// cusps of all hues are at one of its nodes, and the nodes are densest there. Nodes of hue are at
/// the hues where the stage bends.
///
/// The LUT gives what is exact where a channel of the display is 0: two ratios, which are linear in
/// light, and the sum of the channels as a code.
struct HueCube {
    /// What the nodes may be rounded to: next to 0 a code is steep.
    static constexpr double kUnit = 5e-5;

    /// Axes -> axes whose value is in [0, 1].
    double gain = 1;
    // Of hue, saturation and value, in turn:
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
    /// Of the light.
    Primaries primaries = kRec709;
    /// Samples for each node.
    double samples_per_node = 8;
    int rounds = 3;
    unsigned thread_count = 0;
};

/// @param top  light to limit every channel to: the stage saturates there
[[nodiscard]] TONEWRIGHT_API HueCube fit_hue_cube(const HueStructure& structure, double top,
                                                  const HueCubeOptions& options = {});

TONEWRIGHT_NAMESPACE_END
