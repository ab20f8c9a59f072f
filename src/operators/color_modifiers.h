// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "tonewright/color.h"
#include "tonewright/pipeline.h"

/// Color modifications that several operators apply besides their curve.
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
/// @param floor  lower limit of the largest and the smallest channel in the numerator.
inline Expr rrt_saturation(const std::array<Expr, 3>& ap0, double floor) {
    const Expr hi = named("largest", max(max(ap0[0], ap0[1]), ap0[2]));
    const Expr lo = named("smallest", min(min(ap0[0], ap0[1]), ap0[2]));
    return named("saturation", (max(hi, floor) - max(lo, floor)) / max(hi, 0.01));
}

/// First step of the RRT: the glow.
inline std::array<Expr, 3> rrt_glow(const std::array<Expr, 3>& ap0, const Expr& saturation) {
    const auto& [r, g, b] = ap0;
    // b(b-g) + g(g-r) + r(r-b) as a sum of squares, which rounding cannot make negative.
    const Expr chroma =
        named("chroma", sqrt(0.5 * ((r - g) * (r - g) + (g - b) * (g - b) + (b - r) * (b - r))));
    const Expr yc = named("yc", (b + g + r + 1.75 * chroma) / 3);
    const Expr x = named("steepness", (saturation - 0.4) / 0.2);
    const Expr t = named("t", max(1 - abs(x / 2), 0));
    const Expr sigmoid = named("sigmoid", select(less(x, 0), 0.5 * (t * t), 1 - 0.5 * (t * t)));
    // Full up to yc = 2/3 of 0.08, zero from twice 0.08. The floor is below the first value.
    const Expr gain = named("gain", 0.05 * sigmoid * clamp(0.08 / max(yc, 0.05) - 0.5, 0, 1));
    return {named("glowing", r * (1 + gain)), named("glowing", g * (1 + gain)),
            named("glowing", b * (1 + gain))};
}

/// Hue for the second step, the red modifier: radians from red. For neutrals, with saturation 0,
/// atan2(0, 0) = 0.
inline Expr rrt_hue(const std::array<Expr, 3>& ap0) {
    return named("hue",
                 atan2(std::numbers::sqrt3 * (ap0[1] - ap0[2]), 2 * ap0[0] - ap0[1] - ap0[2]));
}

/// The red modifier: red moves towards 0.03.
/// @param weight  of the hue, 1 at red.
inline std::array<Expr, 3> rrt_red_modifier(const std::array<Expr, 3>& ap0, const Expr& weight,
                                            const Expr& saturation) {
    return {named("red", ap0[0] + weight * saturation * (0.03 - ap0[0]) * (1 - 0.82)), ap0[1],
            ap0[2]};
}

/// Colors whose saturation the red modifier uses.
enum class RrtSaturation : unsigned char {
    before_glow,  // the Academy's CTL
    after_glow,   // OpenColorIO
};

/// The first two steps of the RRT, from AP0 to AP0; accepts negatives.
inline CrossTalkStage rrt_glow_and_red_modifier(RrtSaturation choice) {
    constexpr double floor = 1e-10;
    const std::array<Expr, 3> rgb = {Expr::input(0), Expr::input(1), Expr::input(2)};
    const Expr saturation = rrt_saturation(rgb, floor);
    const std::array<Expr, 3> glowing = rrt_glow(rgb, saturation);
    // The cubic B-spline over 135 degrees about red, as a sum of two truncated powers: 1 at red.
    constexpr double interval = 135.0 / 4 * std::numbers::pi / 180;
    const Expr distance = named("hue_distance", abs(rrt_hue(glowing) / interval));
    const Expr outer = named("outer", max(2 - distance, 0));
    const Expr inner = named("inner", max(1 - distance, 0));
    const Expr weight = named("hue_weight", 0.25 * (outer * outer * outer) - inner * inner * inner);
    return {rrt_red_modifier(
        glowing, weight,
        choice == RrtSaturation::after_glow ? rrt_saturation(glowing, floor) : saturation)};
}

/// Both steps for channels >= 0, with the hue weight smoothstep(1 - |2h/135|)^2 that Filament and
/// Unreal use instead of the CTL's B-spline. As in the CTL, the saturation is taken before the
/// glow.
inline std::array<Expr, 3> glow_and_red_modifier(const std::array<Expr, 3>& ap0, double floor) {
    const Expr saturation = rrt_saturation(ap0, floor);
    const std::array<Expr, 3> glowing = rrt_glow(ap0, saturation);
    const Expr degrees = rrt_hue(glowing) * (180 / std::numbers::pi);
    const Expr window = named("window", smoothstep(0, 1, 1 - abs(2 * degrees / 135)));
    return rrt_red_modifier(glowing, window * window, saturation);
}

/// The same from AP1 channels >= 0 to AP1, where red may become negative. A separate stage: if a 3D
/// LUT samples it, the matrices and curves after it stay exact.
inline CrossTalkStage ap1_glow_and_red_modifier(double floor) {
    const std::array<Expr, 3> ap0 = compose({MatrixStage{rgb_to_rgb(kAP1, kAP0)}});
    return {apply_stage(MatrixStage{rgb_to_rgb(kAP0, kAP1)}, glow_and_red_modifier(ap0, floor))};
}

/// Constants of the reference gamut compression (LMT.Academy.ReferenceGamutCompress): for cyan,
/// magenta, yellow.
struct ReferenceGamutCompression {
    static constexpr std::array<double, 3> limit = {1.147, 1.264, 1.312};
    static constexpr std::array<double, 3> threshold = {0.815, 0.803, 0.880};
    static constexpr double power = 1.2;
};

/// The reference gamut compression, in AP1. The distance of a channel from the largest, D = max -
/// c, is unchanged up to u0 = thr a, a = |max|; with u = D - u0 beyond it becomes u0 + u/(1 +
/// (u/s)^p)^(1/p), s = scale a: the standard's formula times a, without its division by a.
inline CrossTalkStage reference_gamut_compression() {
    constexpr auto& limit = ReferenceGamutCompression::limit;
    constexpr auto& threshold = ReferenceGamutCompression::threshold;
    constexpr double power = ReferenceGamutCompression::power;
    const std::array<Expr, 3> c = {Expr::input(0), Expr::input(1), Expr::input(2)};
    const Expr achromatic = named("achromatic", max(max(c[0], c[1]), c[2]));
    const Expr a = named("a", abs(achromatic));
    CrossTalkStage stage{c};
    for (std::size_t i = 0; i < 3; ++i) {
        const double range = limit[i] - threshold[i];
        const double scale =
            range / std::pow(std::pow((1 - threshold[i]) / range, -power) - 1, 1 / power);
        const Expr u = named("u", achromatic - c[i] - threshold[i] * a);
        const Expr s = named("s", scale * a);
        // Symmetric in u and s: the ratio of the smaller to the larger cannot overflow.
        const Expr beyond = named("beyond", max(u, 0));
        constexpr double tiny = 1e-30;
        const Expr ratio = named("ratio", min(beyond, s) / max(max(beyond, s), tiny));
        const Expr compressed =
            named("compressed", min(beyond, s) * pow(1 + pow(ratio, power), -1 / power));
        stage.f[i] = select(less(u, 0), c[i], achromatic - threshold[i] * a - compressed);
    }
    return stage;
}

TONEWRIGHT_NAMESPACE_END
