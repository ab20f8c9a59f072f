// SPDX-License-Identifier: Apache-2.0
//
// AgX, two of its dialects: Troy Sobotka's configuration and Benjamin Wrensch's minimal form.
//
// Source    T. Sobotka, AgX OpenColorIO configuration (github.com/sobotka/AgX), 2022, and the
//           SB2383 sigmoid that its lookup table samples. B. Wrensch, "Minimal AgX Implementation",
//           iolite-engine.com, 2023-09-06; order 7 as in Filament's ToneMapper.cpp.
// In        scene-linear RGB, working primaries Rec.709, D65; domain [0, inf), negatives: clamped
// at 0. Out       CODE VALUES of a 2.2 power; [0, 1], except agx_minimal's polynomial ends of
// -0.0023 and
//           0.9986 (order 6), 0.0029 and 0.982 (order 7), and looks that saturate past 1.
// Kind      clamp, matrix, log and sigmoid, (matrix); monotone on the neutral axis: yes, but order
// 7
//           dips within the lowest 2.5 % of its range.
// Keeps     mid grey 0.18 -> code value 0.5 (agx_sobotka).
// Differs   agx_sobotka uses the sigmoid in closed form where the configuration has its 4096-entry
//           table: 5e-8 apart, the table's own rounding.
// Check     mid grey 0.18 -> (0.500023782, 0.499993460, 0.499991575) (python_check/operators.py).
#include <cmath>

#include "operators/family.h"

namespace tonewright {
namespace {

// clang-format off
constexpr Matrix3 kInset = {{
    {0.842479062253094,  0.0784335999999992, 0.0792237451477643},
    {0.0423282422610123, 0.878468636469772,  0.0791661274605434},
    {0.0423756549057051, 0.0784336,          0.879142973793104}}};
/// Wrensch's "agxEotf" matrix: the inverse of the inset, applied to code values.
constexpr Matrix3 kOutset = {{
    { 1.19687900512017,   -0.0980208811401368, -0.0990297440797205},
    {-0.0528968517574562,  1.15190312990417,   -0.0989611768448433},
    {-0.0529716355144438, -0.0980434501171241,  1.15107367264116}}};
// clang-format on

/// The shaper: log2 from 10 stops below to 6.5 stops above mid grey. Both sources print its ends
/// with seven digits (log2(0.18) - 10 = -12.4739312, log2(0.18) + 6.5 = 4.0260688), so those are
/// the ends.
constexpr double kLowest = -12.47393;
constexpr double kHighest = 4.026069;

/// The clamp of the normalised log value, in scene-linear: a stage of its own, not a part of the
/// curve.
Stage limit_to_shaper() { return ClampStage{std::exp2(kLowest), std::exp2(kHighest)}; }

/// Scene-linear in the shaper's range -> [0, 1]; mid grey -> 10/16.5.
Expr normalised_log(const Expr& x) { return (log2(x) - kLowest) / (kHighest - kLowest); }

/// The SB2383 sigmoid: two hyperbolic arms that meet in the pivot (px, py) with slope k.
struct Sigmoid {
    double px, py, slope, toe_power, shoulder_power;

    [[nodiscard]] static double arm_scale(double lx, double ly, double k, double p) {
        return std::pow(std::pow(k * lx, -p) * (std::pow(k * lx / ly, p) - 1), -1 / p);
    }
    [[nodiscard]] Expr operator()(const Expr& n) const {
        const double toe = -arm_scale(px, py, slope, toe_power);
        const double shoulder = arm_scale(1 - px, 1 - py, slope, shoulder_power);
        const auto arm = [&](double s, double p) {
            const Expr u =
                max(slope * (n - px) / s, 0);  // the other side of the pivot is not this arm's
            return s * (u / pow(1 + pow(u, p), 1 / p)) + py;
        };
        return select(less(n, px), arm(toe, toe_power), arm(shoulder, shoulder_power));
    }
};

/// ASC CDL without clamps, as OCIO 2 configs apply it, on code values.
Pipeline cdl(const Vector3& slope, double power, double saturation) {
    const Expr x = Expr::input();
    CurveStage curve = curve_stage(x);
    for (std::size_t i = 0; i < 3; ++i)
        curve.f[i] = pow(slope[i] * x, power);
    Matrix3 m{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            m[i][j] = (1 - saturation) * kRec709Weights[j] + (i == j ? saturation : 0);
        }
    }
    // The clamp keeps the power's infinite slope at 0 out of the sigmoid's table.
    return {ClampStage{0, kInfinity}, curve, MatrixStage{m}};
}

Operator sobotka() {
    Operator op;
    op.id = "agx_sobotka";
    op.title = "AgX (Sobotka)";
    op.view = "AgX Sobotka";
    op.character =
        "low contrast, colours fade to white with light; holds blues and neon where others clip";
    op.source = "T. Sobotka, AgX configuration for OpenColorIO (SB2383), 2022";
    op.licence = "formula and constants; no file of it is used";
    op.negatives = kNegativesClampAtZero;
    op.output = OutputKind::code_value;
    op.code_power = 2.2;
    op.looks = {{"golden", "Golden", "warm: ASC CDL slope 1 0.9 0.5, power 0.8, saturation 1.3"},
                {"punchy", "Punchy", "darker and stronger: ASC CDL power 1.35, saturation 1.4"}};
    op.warnings = {
        "this is not the AgX of Blender: mid grey is shown at code value 0.5, Blender's at 0.46"};
    op.build = [](const Params& p) -> Pipeline {
        constexpr Sigmoid sigmoid = {10 / 16.5, 0.5, 2.0, 3.0, 3.25};
        Pipeline stages = {limit_to_positive(), MatrixStage{kInset}, limit_to_shaper(),
                           curve_stage(sigmoid(normalised_log(Expr::input())))};
        Pipeline look;
        if (p.look() == "golden") look = cdl({1, 0.9, 0.5}, 0.8, 1.3);
        if (p.look() == "punchy") look = cdl({1, 1, 1}, 1.35, 1.4);
        stages.insert(stages.end(), look.begin(), look.end());
        return stages;
    };
    return op;
}

Operator minimal() {
    Operator op;
    op.id = "agx_minimal";
    op.title = "AgX (minimal, Wrensch)";
    op.view = "AgX Minimal";
    op.character =
        "AgX of shaders: a polynomial for the sigmoid and the inset undone; more saturated than "
        "Sobotka's";
    op.source = "B. Wrensch, Minimal AgX Implementation, 2023; order 7: Filament ToneMapper.cpp";
    op.licence = "MIT";
    op.negatives = kNegativesClampAtZero;
    op.output = OutputKind::code_value;
    op.code_power = 2.2;
    op.parameters = {choice_parameter("order", {"6", "7"}, "6", "order of the polynomial")};
    op.presets = {{"order7", "with Filament's polynomial", {{"order", "7"}}}};
    op.warnings = {"order 7 lifts black, never reaches white and is not monotone near black"};
    op.build = [](const Params& p) -> Pipeline {
        const Expr n = normalised_log(Expr::input());
        const Expr n2 = n * n;
        const Expr n4 = n2 * n2;
        const Expr n6 = n4 * n2;
        const Expr f = p.choice("order") == "6"
                           ? 15.5 * n4 * n2 - 40.14 * n4 * n + 31.96 * n4 - 6.868 * n2 * n +
                                 0.4298 * n2 + 0.1191 * n - 0.00232
                           : -17.86 * n6 * n + 78.01 * n6 - 126.7 * n4 * n + 92.06 * n4 -
                                 28.72 * n2 * n + 4.361 * n2 - 0.1718 * n + 0.002857;
        return {limit_to_positive(), MatrixStage{kInset}, limit_to_shaper(), curve_stage(f),
                MatrixStage{kOutset}};
    };
    return op;
}

}  // namespace

std::vector<Operator> define_agx() { return {sobotka(), minimal()}; }

}  // namespace tonewright
