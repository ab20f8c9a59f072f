// SPDX-License-Identifier: Apache-2.0
//
// Curve fits to the look of ACES 1: Narkowicz 2015, Hill (BakingLab) 2016, Filament, Cesium,
// Galacean.
//
// Source    K. Narkowicz, "ACES Filmic Tone Mapping Curve", knarkowicz.wordpress.com, 2016-01-06.
//           S. Hill, in M. Pettineo and B. Karis' BakingLab, ACES.hlsl, 2016; the gains as Godot
//           (tonemap.glsl) and three.js (tonemapping_pars_fragment) have them. Google Filament,
//           ToneMapper.cpp, ACES and ACESLegacy, whose rational is a fit of the colour-science
//           project (colour-unity). CesiumJS, @cesium/engine 26.3.0, AcesTonemappingStage, whose
//           comment names Narkowicz. Galacean, @galacean/engine-core 1.6.13, ACESTonemap, whose
//           curve is Hill's. aces_narkowicz without the clamp: PlayCanvas 2.23.3
//           (TONEMAP_ACES), claygl 1.3.0, Orillusion 0.9.2; aces_hill without the clamp: hdrify
//           1.2.1.
// In        scene-linear RGB; working primaries Rec.709 (aces_filament Rec.2020), D65; domain [0,
//           inf), negatives clamped at 0 (Narkowicz's rational has a zero at -0.012 and rises again
//           below it).
// Out       display-linear RGB, 1.0 = display peak. Narkowicz, Hill and Cesium end with a clamp
//           to [0, 1], which Godot and the presets `unclamped` leave out. Filament does not clamp
//           and stays below 1. Galacean's pass clamps after the function; here the display does.
// Kind      aces_narkowicz, aces_cesium per channel; aces_hill matrix, curve, matrix; aces_filament
// 3D (glow and
//           red modifier), then matrix, curve, scale by luminance (dim surround), matrix, and
//           aces_galacean the same with other matrices. Monotone
//           on the neutral axis: yes (Hill: 0 up to scene-linear 0.0032).
// Keeps     0 -> 0, except -0.0005 of Godot and -0.0004 of aces_hill:unclamped. At 65504 all reach
// their asymptotes. Differs   aces_filament: for the dim surround Filament floors X+Y+Z at 1e-5,
// which only prevents
//           0/0 at black; here black stays black. aces_galacean floors the sum and y at 1e-4,
//           which adds blue to colors below 1e-4, and lets colors of small y fade to black; here
//           the chromaticity stays, and luminance below 5e-7 fades to black. Hill's matrices
//           include the conversions from and to Rec.709 and the desaturation of the RRT and the
//           ODT: the input is Rec.709, not ACEScg. Filament does not adapt its conversions between
//           Rec.2020 and AP1 from D65 to the ACES white, so it tints grays; the source does the
//           same. No variant includes a display encoding.
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
             "factor on the scene value; the author uses 0.6 to match the exposure of ACES"),
         choice_parameter("clamp", {"yes", "no"}, "yes", "limit the result to [0, 1]")});
    op.presets = {
        {"matched", "0.6 prescale, which matches the exposure of ACES", {{"prescale", "0.6"}}},
        {"unclamped", "PlayCanvas, claygl, Orillusion: not limited to 1", {{"clamp", "no"}}}};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, 1.033, "unclamped"}};
    op.build = [](const Params& p) -> Pipeline {
        const Expr x = p.expr("prescale") * Expr::input();
        const Expr f = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
        const Pipeline tone = tone_curve_pipeline({.f = f}, p);
        return p.choice("clamp") == "yes" ? tone + Pipeline{ClampStage{0, 1}} : tone;
    };
    return op;
}

Operator cesium() {
    Operator op;
    op.id = "aces_cesium";
    op.title = "ACES fit (Cesium)";
    op.view = "ACES Cesium";
    op.character =
        "Hill's curve with rounded constants on the channels, without his matrices: bright colors "
        "stay saturated";
    op.source = "CesiumJS, @cesium/engine 26.3.0, AcesTonemappingStage";
    op.license = "Apache-2.0; formula and constants only; none of its code is used";
    op.dialects = "ACES";
    op.negatives = kNegativesClampAtZero;
    op.parameters = with_apply("channels");
    op.differences = {{DocumentedDifference::Kind::crushes_black, 0.0015, ""}};
    op.build = [](const Params& p) -> Pipeline {
        const Expr x = Expr::input();
        const Expr f = (x * (x + 0.065) - 0.0001) / (x * (0.985 * x + 0.433) + 0.238);
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
         "Godot (Forward+, Mobile): prescale 1.8, divided by the curve at white, not clamped",
         {{"prescale", "1.8"}, {"white", "1"}, {"clamp", "no"}}},
        {"threejs", "three.js: prescale 1/0.6", {{"prescale", "1.6666666666666667"}}},
        {"unclamped", "hdrify: not limited to [0, 1]", {{"clamp", "no"}}},
    };
    op.differences = {{DocumentedDifference::Kind::crushes_black, 0.0032, ""},
                      {DocumentedDifference::Kind::crushes_black, 0.0018, "godot"},
                      {DocumentedDifference::Kind::crushes_black, 0.0019, "threejs"},
                      {DocumentedDifference::Kind::black, -0.00049, "godot"},
                      {DocumentedDifference::Kind::black, -0.00038, "unclamped"},
                      {DocumentedDifference::Kind::exceeds_white, 1.8, "bakinglab"},
                      {DocumentedDifference::Kind::exceeds_white, 1.3, "godot"},
                      {DocumentedDifference::Kind::exceeds_white, 1.02, "unclamped"}};
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

// clang-format off
/// Matrices of Galacean, as it prints them.
constexpr Matrix3 kGalaceanToAp0 = {{{0.4397010, 0.3829780, 0.1773350},
                                     {0.0897923, 0.8134230, 0.0967616},
                                     {0.0175440, 0.1115440, 0.8707040}}};
constexpr Matrix3 kGalaceanAp0ToAp1 = {{{ 1.4514393161, -0.2365107469, -0.2149285693},
                                        {-0.0765537734,  1.1762296998, -0.0996759264},
                                        { 0.0083161484, -0.0060324498,  0.9977163014}}};
constexpr Matrix3 kGalaceanAp1ToXyz = {{{ 0.6624541811, 0.1340042065, 0.1561876870},
                                        { 0.2722287168, 0.6740817658, 0.0536895174},
                                        {-0.0055746495, 0.0040607335, 1.0103391003}}};
constexpr Matrix3 kGalaceanXyzToAp1 = {{{ 1.6410233797, -0.3248032942, -0.2364246952},
                                        {-0.6636628587,  1.6153315917,  0.0167563477},
                                        { 0.0117218943, -0.0082844420,  0.9883948585}}};
constexpr Matrix3 kGalaceanD60ToD65 = {{{ 0.987224,   -0.00611327, 0.0159533},
                                        {-0.00759836,  1.00186,    0.00533002},
                                        { 0.00307257, -0.00509595, 1.08168}}};
constexpr Matrix3 kGalaceanXyzToRec709 = {{{ 3.2409699419, -1.5373831776, -0.498610760},
                                           {-0.9692436363,  1.8759675015,  0.0415550574},
                                           { 0.0556300797, -0.2039769589,  1.0569715142}}};
// clang-format on

Operator galacean() {
    Operator op;
    op.id = "aces_galacean";
    op.title = "ACES fit (Galacean)";
    op.view = "ACES Galacean";
    op.character =
        "glow and red modifier of the RRT, Hill's curve and dim surround: the closest of the fits "
        "to ACES 1";
    op.source = "Galacean, @galacean/engine-core 1.6.13, ACESTonemap";
    op.license = "MIT; formula and constants only; none of its code is used";
    op.dialects = "ACES";
    op.negatives = kNegativesClampAtZero;
    op.differences = {{DocumentedDifference::Kind::crushes_black, 0.0032, ""},
                      {DocumentedDifference::Kind::exceeds_white, 1.02, ""}};
    op.bounds = {.lut3d = 0.1,
                 .reason = "a 3D LUT of glow and red modifier, which change colors near black"};
    op.build = [](const Params&) -> Pipeline {
        const Vector3 w = kGalaceanAp1ToXyz[1];
        const std::array<Expr, 3> ap0 = {Expr::input(0), Expr::input(1), Expr::input(2)};
        const Expr Y = Expr::input();
        // The identity but for the printed digits.
        const Matrix3 through_xyz = multiply(kGalaceanXyzToAp1, kGalaceanAp1ToXyz);
        const Matrix3 to_rec709 =
            multiply(kGalaceanXyzToRec709, multiply(kGalaceanD60ToD65, kGalaceanAp1ToXyz));
        return {
            limit_to_positive(), MatrixStage{kGalaceanToAp0, "to_ap0"},
            ClampStage{0, kInfinity},  // no effect: the matrix has no negative number
            named("glow_and_red_modifier", CrossTalkStage{glow_and_red_modifier(ap0, 1e-4)}),
            MatrixStage{kGalaceanAp0ToAp1, "to_ap1"}, ClampStage{0, kInfinity},
            MatrixStage{saturation_matrix(0.96, w), "rrt_saturation"},
            named("rrt_and_odt_fit", curve_stage(hill_curve(Expr::input()))),
            // To the dim surround: Y^0.9811, same chromaticity.
            ToneScaleStage{ToneScaleStage::Norm::luminance, w, pow(Y, 0.9811) * min(Y / 5e-7, 1)},
            MatrixStage{through_xyz, "through_xyz"},
            MatrixStage{saturation_matrix(0.93, w), "odt_saturation"},
            MatrixStage{to_rec709, "to_rec709"}};
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
    op.warnings = {
        "Filament shows a 3D LUT of this formula, up to 6 8-bit code values from it with 64 nodes "
        "a "
        "side"};
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
    return {narkowicz(),
            hill(),
            filament(),
            cesium(),
            galacean(),
            hill_misplaced_bracket(),
            hill_misprinted_product()};
}

TONEWRIGHT_NAMESPACE_END
