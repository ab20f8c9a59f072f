// SPDX-License-Identifier: Apache-2.0
//
// Curve fits to the ACES 1 look: Narkowicz 2015 and Hill (BakingLab) 2016.
//
// Source    K. Narkowicz, "ACES Filmic Tone Mapping Curve", knarkowicz.wordpress.com, 2016-01-06.
//           S. Hill, in M. Pettineo and B. Karis' BakingLab, ACES.hlsl, 2016.
// In        scene-linear RGB, working primaries Rec.709, D65; domain [0, inf), negatives: clamped
// at 0
//           (Narkowicz' rational has a zero at -0.012 and rises again below it).
// Out       display-linear RGB, 1.0 = display peak; both sources end with a clamp to [0, 1].
// Kind      aces_narkowicz per channel; aces_hill matrix, curve, matrix. Monotone on the neutral
//           axis: yes (Hill: 0 up to scene-linear 0.0032).
// Keeps     0 -> 0.
// Differs   nowhere. Hill's matrices hold the conversions from and to Rec.709 and the RRT's and
// ODT's
//           desaturation: the input is Rec.709, not ACEScg. Neither contains the display encoding.
// Check     mid grey 0.18 -> 0.266898920 (Narkowicz; 0.140119567 with prescale 0.6), 0.105591247
//           (Hill, red) (python_check/operators.py).
#include "operators/family.h"

namespace tonewright {
namespace {

Operator narkowicz() {
    Operator op;
    op.id = "aces_narkowicz";
    op.title = "ACES fit (Narkowicz)";
    op.view = "ACES Narkowicz";
    op.character =
        "five constants, contrasty; without the 0.6 prescale about a stop brighter than ACES";
    op.source = "K. Narkowicz, ACES Filmic Tone Mapping Curve, 2016";
    op.licence = "public domain (CC0), MIT";
    op.negatives = kNegativesClampAtZero;
    op.parameters = {
        number_parameter("prescale", "", 1, 0.01, 100,
                         "factor on the scene value; 0.6 is the author's match to ACES exposure")};
    op.presets = {
        {"matched", "with the 0.6 prescale that matches ACES exposure", {{"prescale", "0.6"}}}};
    op.build = [](const Params& p) -> Pipeline {
        const Expr x = p.number("prescale") * Expr::input();
        const Expr f = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
        return {limit_to_positive(), curve_stage(f), ClampStage{0, 1}};
    };
    return op;
}

// clang-format off
constexpr Matrix3 kHillInput = {{{0.59719, 0.35458, 0.04823},
                                 {0.07600, 0.90834, 0.01566},
                                 {0.02840, 0.13383, 0.83777}}};
constexpr Matrix3 kHillOutput = {{{ 1.60475, -0.53108, -0.07367},
                                  {-0.10208,  1.10813, -0.00605},
                                  {-0.00327, -0.07276,  1.07602}}};
// clang-format on

Operator hill() {
    Operator op;
    op.id = "aces_hill";
    op.title = "ACES fit (Hill)";
    op.view = "ACES Hill";
    op.character = "close to ACES 1 SDR with its desaturating lights; darker than Narkowicz";
    op.source = "S. Hill, ACES.hlsl of BakingLab, 2016";
    op.licence = "MIT";
    op.negatives = kNegativesClampAtZero;
    op.build = [](const Params&) -> Pipeline {
        const Expr v = Expr::input();
        const Expr a = v * (v + 0.0245786) - 0.000090537;
        const Expr b = v * (0.983729 * v + 0.4329510) + 0.238081;
        return {limit_to_positive(), MatrixStage{kHillInput}, curve_stage(a / b),
                MatrixStage{kHillOutput}, ClampStage{0, 1}};
    };
    return op;
}

}  // namespace

std::vector<Operator> define_aces_fits() { return {narkowicz(), hill()}; }

}  // namespace tonewright
