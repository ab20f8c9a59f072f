// SPDX-License-Identifier: Apache-2.0
//
// Curve fits to the look of ACES 1: Narkowicz 2015, Hill (BakingLab) 2016, Filament.
//
// Source    K. Narkowicz, "ACES Filmic Tone Mapping Curve", knarkowicz.wordpress.com, 2016-01-06.
//           S. Hill, in M. Pettineo and B. Karis' BakingLab, ACES.hlsl, 2016; the gains as Godot
//           (tonemap.glsl) and three.js (tonemapping_pars_fragment) have them. Google Filament,
//           ToneMapper.cpp, ACES and ACESLegacy, whose rational is a fit of the colour-science
//           project (colour-unity).
// In        scene-linear RGB; working primaries Rec.709 (aces_filament Rec.2020), D65; domain [0,
//           inf), negatives clamped at 0 (Narkowicz's rational has a zero at -0.012 and rises again
//           below it).
// Out       display-linear RGB, 1.0 = display peak. Narkowicz and Hill end with a clamp to [0, 1],
//           which Godot leaves out; Filament does not clamp and stays below 1.
// Kind      aces_narkowicz per channel; aces_hill matrix, curve, matrix; aces_filament 3D (glow and
//           red modifier), then matrix, curve, scale by luminance (dim surround), matrix. Monotone
//           on the neutral axis: yes (Hill: 0 up to scene-linear 0.0032).
// Keeps     0 -> 0, except Godot's unclamped -0.0005. At 65504 all reach their asymptotes.
// Differs   aces_filament: for the dim surround Filament floors X+Y+Z at 1e-5, which only prevents
//           0/0 at black; here black stays black. Hill's matrices include the conversions from and
//           to Rec.709 and the desaturation of the RRT and the ODT: the input is Rec.709, not
//           ACEScg. Filament does not adapt its conversions between Rec.2020 and AP1 from D65 to
//           the ACES white, so it tints grays; the source does the same. No variant includes a
//           display encoding.
// Check     mid gray 0.18 -> 0.266898920 (Narkowicz; 0.140119567 with prescale 0.6), red
//           0.105591247 (Hill), 0.106938283 (Filament, Rec.2020) (check_values.json).
#include "base/format_number.h"
#include "operators/color_modifiers.h"
#include "operators/family.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

Operator narkowicz() {
    Operator op;
    op.id = "aces_narkowicz";
    op.title = "ACES fit (Narkowicz)";
    op.view = "ACES Narkowicz";
    op.character =
        "five constants, high contrast; about a stop brighter than ACES unless the prescale is 0.6";
    op.source = "K. Narkowicz, ACES Filmic Tone Mapping Curve, 2016";
    op.license = "public domain (CC0), MIT";
    op.dialects = "ACES";
    op.negatives = kNegativesClampAtZero;
    op.parameters = with_apply(
        "channels",
        {number_parameter(
            "prescale", "", 1, 0.01, 100,
            "factor on the scene value; the author uses 0.6 to match the exposure of ACES")});
    op.presets = {
        {"matched", "0.6 prescale, which matches the exposure of ACES", {{"prescale", "0.6"}}}};
    op.build = [](const Params& p) -> Pipeline {
        const Expr x = p.expr("prescale") * Expr::input();
        const Expr f = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
        return tone_curve_pipeline({.f = f}, p) + Pipeline{ClampStage{0, 1}};
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

Expr hill_curve(const Expr& v) {
    const Expr a = named("numerator", v * (v + 0.0245786) - 0.000090537);
    const Expr b = named("denominator", v * (0.983729 * v + 0.4329510) + 0.238081);
    return a / b;
}

Operator hill() {
    Operator op;
    op.id = "aces_hill";
    op.title = "ACES fit (Hill)";
    op.view = "ACES Hill";
    op.character = "close to ACES 1 SDR, including desaturated highlights; darker than Narkowicz";
    op.source = "S. Hill, ACES.hlsl of BakingLab, 2016; gains of Godot and three.js";
    op.license = "MIT";
    op.dialects = "ACES";
    op.negatives = kNegativesClampAtZero;
    op.parameters = {
        number_parameter("prescale", "", 1, 0.01, 100, "factor on the scene value"),
        number_parameter("gain", "", 1, 0.01, 100, "factor on the result, after the clamp"),
        number_parameter("white", "scene-linear", 0, 0, 65504,
                         "scene value before the prescale; the result is divided by the curve at "
                         "this value (0: no division)"),
        choice_parameter("clamp", {"yes", "no"}, "yes",
                         "limit the result to [0, 1] before the gain"),
    };
    op.presets = {
        {"bakinglab", "BakingLab: clamped result times 1.8", {{"gain", "1.8"}}},
        {"godot",
         "Godot: prescale 1.8, divided by the curve at white, not clamped",
         {{"prescale", "1.8"}, {"white", "1"}, {"clamp", "no"}}},
        {"threejs", "three.js: prescale 1/0.6", {{"prescale", "1.6666666666666667"}}},
    };
    op.differences = {{DocumentedDifference::Kind::crushes_black, 0.0032, ""},
                      {DocumentedDifference::Kind::crushes_black, 0.0018, "godot"},
                      {DocumentedDifference::Kind::crushes_black, 0.0019, "threejs"},
                      {DocumentedDifference::Kind::black, -0.00049, "godot"},
                      {DocumentedDifference::Kind::exceeds_white, 1.8, "bakinglab"},
                      {DocumentedDifference::Kind::exceeds_white, 1.3, "godot"}};
    op.build = [](const Params& p) -> Pipeline {
        const Expr prescale = p.expr("prescale");
        const Expr white = p.expr("white");
        const Expr at_white =
            named("at_white", select(less(0, white), hill_curve(prescale * white), 1));
        if (fails(less(0, at_white))) {
            throw Error("white is " + shortest(white.value()) + "; expected 0 or above " +
                        shortest(0.0033 / prescale.value()) +
                        " with this prescale: the curve is not above 0 there");
        }
        Pipeline stages = {
            limit_to_positive(), scale_stage(prescale), MatrixStage{kHillInput, "input"},
            named("rrt_and_odt_fit", curve_stage(hill_curve(Expr::input()) / at_white)),
            MatrixStage{kHillOutput, "output"}};
        if (p.choice("clamp") == "yes") stages.push_back(ClampStage{0, 1});
        stages.push_back(scale_stage(p.expr("gain")));
        return stages;
    };
    return op;
}

/// The factor of the denominator's first term stands outside its bracket.
Operator hill_misplaced_bracket() {
    Operator op =
        defect_of("aces_hill:threejs", "aces_hill_misplaced_bracket",
                  "three.js for WebGPU (mrdoob/three.js 0a0cd973, ToneMappingFunctions.js)",
                  "a misplaced bracket in the denominator: v (v + 0.432951) 0.983729 instead of v "
                  "(0.983729 v + 0.432951)");
    op.differences = {{DocumentedDifference::Kind::crushes_black, 0.0019, ""}};
    op.build = [](const Params&) -> Pipeline {
        const Expr v = Expr::input();
        const Expr a = named("numerator", v * (v + 0.0245786) - 0.000090537);
        const Expr b = named("denominator", v * ((v + 0.4329510) * 0.983729) + 0.238081);
        return {limit_to_positive(),
                scale_stage(1 / 0.6),
                MatrixStage{kHillInput, "input"},
                named("rrt_and_odt_fit", curve_stage(a / b)),
                MatrixStage{kHillOutput, "output"},
                ClampStage{0, 1}};
    };
    return op;
}

/// The page's mul() reads green where it should read red, in the second and the third row.
Matrix3 green_for_red(const Matrix3& m) {
    return {{{m[0][0], m[0][1], m[0][2]},
             {0, m[1][0] + m[1][1], m[1][2]},
             {0, m[2][0] + m[2][1], m[2][2]}}};
}

Operator hill_misprinted_product() {
    Operator op = defect_of("aces_hill", "aces_hill_misprinted_product",
                            "the page 64.github.io/tonemapping (before its commit 936048c)",
                            "its matrix product reads green instead of red in two rows, so grays "
                            "are right and colors are wrong");
    op.differences = {{DocumentedDifference::Kind::crushes_black, 0.0032, ""},
                      {DocumentedDifference::Kind::black, -0.00038, ""},
                      {DocumentedDifference::Kind::exceeds_white, 1.02, ""}};
    op.build = [](const Params&) -> Pipeline {
        return {limit_to_positive(), MatrixStage{green_for_red(kHillInput), "input"},
                named("rrt_and_odt_fit", curve_stage(hill_curve(Expr::input()))),
                MatrixStage{green_for_red(kHillOutput), "output"}};
    };
    return op;
}

/// From Rec.2020 through XYZ without adaptation: D65 stays D65, which is not neutral in AP1.
Matrix3 rec2020_to_ap1_unadapted() {
    return multiply(inverse(rgb_to_xyz(kAP1)), rgb_to_xyz(kRec2020));
}

Operator filament() {
    Operator op;
    op.id = "aces_filament";
    op.title = "ACES fit (Filament)";
    op.view = "ACES Filament";
    op.character =
        "glow and red modifier of the RRT before a fitted curve; whites turn reddish, because its "
        "conversions are not adapted";
    op.source = "Google Filament, ToneMapper.cpp: ACES, ACESLegacy";
    op.license = "Apache-2.0; formula and constants only; none of its code is used";
    op.dialects = "ACES";
    op.negatives = kNegativesClampAtZero;
    op.working = kRec2020;
    // The two weights differ by up to 0.0074. Their largest effect on any color is 7.37e-3 on sRGB,
    // at Rec.2020 11.4, 0, 6.8 (test_operators.py).
    op.bounds = {.lut3d = 7.4e-3,
                 .reason = "OpenColorIO's fixed functions weight hues near red differently"};
    op.parameters = {number_parameter(
        "brightness", "", 1, 0.01, 100,
        "factor before the curve: 1 for Filament's ACES, 1/0.6 for its ACESLegacy")};
    op.presets = {{"legacy", "Filament's ACESLegacy", {{"brightness", "1.6666666666666667"}}}};
    op.differences = {{DocumentedDifference::Kind::never_reaches_white, 0.869, ""},
                      {DocumentedDifference::Kind::tints_gray, 0.057, ""}};
    op.build = [](const Params& p) -> Pipeline {
        const Matrix3 to_ap1 = rec2020_to_ap1_unadapted();
        const Vector3 w = ap1_weights();
        const Expr x = Expr::input();
        return {limit_to_positive(), MatrixStage{to_ap1, "to_ap1"},
                ClampStage{0, kInfinity},  // no effect: Rec.2020 lies inside AP1
                ap1_glow_and_red_modifier(1e-5), ClampStage{0, kHalfMax},
                MatrixStage{saturation_matrix(0.96, w), "rrt_saturation"},
                scale_stage(p.expr("brightness")),
                curve_stage((x * (2.785085 * x + 0.107772)) /
                            (x * (2.936045 * x + 0.887122) + 0.806889)),
                // To the dim surround: Y^0.9811, same chromaticity.
                ToneScaleStage{ToneScaleStage::Norm::luminance, w, pow(x, 0.9811)},
                MatrixStage{saturation_matrix(0.93, w), "odt_saturation"},
                MatrixStage{inverse(to_ap1), "from_ap1"}};
    };
    return op;
}

}  // namespace

std::vector<Operator> define_aces_fits() {
    return {narkowicz(), hill(), filament(), hill_misplaced_bracket(), hill_misprinted_product()};
}

TONEWRIGHT_NAMESPACE_END
