// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "tonewright/color.h"
#include "tonewright/pipeline.h"

/// What several operators do to colour beside their curve.
namespace tonewright {

/// s I + (1 - s) [w; w; w]: saturation about the luminance of weights w.
inline Matrix3 saturation_matrix(double s, const Vector3& weights) {
    Matrix3 m{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j)
            m[i][j] = (1 - s) * weights[j] + (i == j ? s : 0);
    }
    return m;
}

/// Weights of relative luminance of AP1: the row of Y of its matrix to XYZ.
inline Vector3 ap1_weights() { return rgb_to_xyz(kAP1)[1]; }

/// Glow and red modifier of the ACES rendering transform, of AP0 light >= 0: the first two steps of
/// RRT.ctl (ACES 1.0.3), with the hue weight smoothstep(1 - |2h/135|)^2 that Filament and Unreal
/// have in place of the CTL's B-spline. As in the CTL the saturation is the one before the glow.
/// @param floor  of the largest and the smallest channel in the saturation's numerator.
inline std::array<Expr, 3> glow_and_red_modifier(const std::array<Expr, 3>& ap0, double floor) {
    const auto& [r, g, b] = ap0;
    const Expr hi = max(max(r, g), b);
    const Expr lo = min(min(r, g), b);
    const Expr saturation = (max(hi, floor) - max(lo, floor)) / max(hi, 0.01);

    // b(b-g) + g(g-r) + r(r-b) as a sum of squares: never below 0, whatever is rounded.
    const Expr chroma = sqrt(0.5 * ((r - g) * (r - g) + (g - b) * (g - b) + (b - r) * (b - r)));
    const Expr yc = (b + g + r + 1.75 * chroma) / 3;
    const Expr x = (saturation - 0.4) / 0.2;
    const Expr t = max(1 - abs(x / 2), 0);
    const Expr sigmoid = select(less(x, 0), 0.5 * (t * t), 1 - 0.5 * (t * t));
    // Full up to yc = 2/3 of 0.08, none from twice 0.08 on. The floor stands below the former.
    const Expr gain = 0.05 * sigmoid * clamp(0.08 / max(yc, 0.05) - 0.5, 0, 1);
    std::array<Expr, 3> out = {r * (1 + gain), g * (1 + gain), b * (1 + gain)};

    // Neutrals: atan2(0, 0) is 0, and so is their saturation.
    const Expr hue = atan2(std::numbers::sqrt3 * (out[1] - out[2]), 2 * out[0] - out[1] - out[2]);
    const Expr degrees = hue * (180 / std::numbers::pi);
    const Expr window = smoothstep(0, 1, 1 - abs(2 * degrees / 135));
    out[0] = out[0] + window * window * saturation * (0.03 - out[0]) * (1 - 0.82);
    return out;
}

/// The same from AP1 light >= 0 to AP1 light, of which red may come out below 0. A stage of its
/// own: the matrices and curves that follow stay exact where this has to be sampled.
inline Map3Stage ap1_glow_and_red_modifier(double floor) {
    const std::array<Expr, 3> ap0 = compose({MatrixStage{rgb_to_rgb(kAP1, kAP0)}});
    return {apply_stage(MatrixStage{rgb_to_rgb(kAP0, kAP1)}, glow_and_red_modifier(ap0, floor))};
}

}  // namespace tonewright
