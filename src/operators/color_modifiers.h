// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "tonewright/color.h"
#include "tonewright/pipeline.h"

/// What several operators do to colour beside their curve.
TONEWRIGHT_NAMESPACE_BEGIN

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

/// Saturation of the ACES rendering transform (RRT.ctl, ACES 1.0.3), of AP0 light.
/// @param floor  of the largest and the smallest channel in the numerator.
inline Expr rrt_saturation(const std::array<Expr, 3>& ap0, double floor) {
    const Expr hi = max(max(ap0[0], ap0[1]), ap0[2]);
    const Expr lo = min(min(ap0[0], ap0[1]), ap0[2]);
    return (max(hi, floor) - max(lo, floor)) / max(hi, 0.01);
}

/// Its first step, the glow.
inline std::array<Expr, 3> rrt_glow(const std::array<Expr, 3>& ap0, const Expr& saturation) {
    const auto& [r, g, b] = ap0;
    // b(b-g) + g(g-r) + r(r-b) as a sum of squares: never below 0, whatever is rounded.
    const Expr chroma = sqrt(0.5 * ((r - g) * (r - g) + (g - b) * (g - b) + (b - r) * (b - r)));
    const Expr yc = (b + g + r + 1.75 * chroma) / 3;
    const Expr x = (saturation - 0.4) / 0.2;
    const Expr t = max(1 - abs(x / 2), 0);
    const Expr sigmoid = select(less(x, 0), 0.5 * (t * t), 1 - 0.5 * (t * t));
    // Full up to yc = 2/3 of 0.08, none from twice 0.08 on. The floor stands below the former.
    const Expr gain = 0.05 * sigmoid * clamp(0.08 / max(yc, 0.05) - 0.5, 0, 1);
    return {r * (1 + gain), g * (1 + gain), b * (1 + gain)};
}

/// Hue of its second step, the red modifier: radians from red. Of neutrals, whose saturation is 0,
/// atan2(0, 0) = 0.
inline Expr rrt_hue(const std::array<Expr, 3>& ap0) {
    return atan2(std::numbers::sqrt3 * (ap0[1] - ap0[2]), 2 * ap0[0] - ap0[1] - ap0[2]);
}

/// The red modifier: red moves towards 0.03.
/// @param weight  of the hue, 1 at red.
inline std::array<Expr, 3> rrt_red_modifier(const std::array<Expr, 3>& ap0, const Expr& weight,
                                            const Expr& saturation) {
    return {ap0[0] + weight * saturation * (0.03 - ap0[0]) * (1 - 0.82), ap0[1], ap0[2]};
}

/// Both, of light >= 0, with the hue weight smoothstep(1 - |2h/135|)^2 that Filament and Unreal
/// have in place of the CTL's B-spline. As in the CTL the saturation is the one before the glow.
inline std::array<Expr, 3> glow_and_red_modifier(const std::array<Expr, 3>& ap0, double floor) {
    const Expr saturation = rrt_saturation(ap0, floor);
    const std::array<Expr, 3> glowing = rrt_glow(ap0, saturation);
    const Expr degrees = rrt_hue(glowing) * (180 / std::numbers::pi);
    const Expr window = smoothstep(0, 1, 1 - abs(2 * degrees / 135));
    return rrt_red_modifier(glowing, window * window, saturation);
}

/// The same from AP1 light >= 0 to AP1 light, of which red may come out below 0. A stage of its
/// own: the matrices and curves that follow stay exact where this has to be sampled.
inline CrossTalkStage ap1_glow_and_red_modifier(double floor) {
    const std::array<Expr, 3> ap0 = compose({MatrixStage{rgb_to_rgb(kAP1, kAP0)}});
    return {apply_stage(MatrixStage{rgb_to_rgb(kAP0, kAP1)}, glow_and_red_modifier(ap0, floor))};
}

TONEWRIGHT_NAMESPACE_END
