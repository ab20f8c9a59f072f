// SPDX-License-Identifier: Apache-2.0
//
// The colors of the test chart, which LUTs are measured along.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tonewright/color.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Hue in [0, 1): red, yellow, green, cyan, blue, magenta. The largest channel is `value`.
[[nodiscard]] TONEWRIGHT_API Vector3 hue_color(double hue, double saturation, double value);

/// Colors of the chart's gradients of exposure: gray, the light skin of the ColorChecker, orange, a
/// deep blue lamp. Scene-linear Rec.709.
inline constexpr std::array<Vector3, 4> kGradientTints = {
    {{1, 1, 1}, {1, 0.56, 0.42}, {1, 0.25, 0.02}, {0.06, 0.10, 1}}};

/// Light at the center of the chart's shining spheres, scene-linear Rec.709: red, green, blue, and
/// the magenta of a neon tube.
inline constexpr std::array<Vector3, 4> kLamps = {
    {{40, 0, 0}, {0, 24, 0}, {0, 0, 60}, {46, 0.6, 30}}};

struct NamedColor {
    std::string name;  // "red of P3-D65"
    Vector3 rgb{};     // scene-linear Rec.709, its largest channel near 1
};
/// One color for each lamp and hue of the chart: its sweeps of pure and half saturated hues, the
/// primaries and secondaries of Rec.709, P3 and Rec.2020, its gradients and its lamps.
[[nodiscard]] TONEWRIGHT_API std::vector<NamedColor> chart_colors();

TONEWRIGHT_NAMESPACE_END
