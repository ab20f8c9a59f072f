// SPDX-License-Identifier: Apache-2.0
//
// AgX, seven dialects: Troy Sobotka's configuration, Benjamin Wrensch's minimal version, and the
// versions of three.js, Filament, Godot (4.4, and since 4.6) and Needle Engine.
//
// Source    T. Sobotka, AgX OpenColorIO configuration (github.com/sobotka/AgX), 2022, and the
//           SB2383 sigmoid that its lookup table samples. B. Wrensch, "Minimal AgX Implementation",
//           iolite-engine.com, 2023-09-06. three.js, tonemapping_pars_fragment, AgXToneMapping.
//           Google Filament, ToneMapper.cpp, AgxToneMapper. Godot Engine, tonemap.glsl of 4.4 and
//           of 4.6 (curve by allenwp). three.js r160, and r161 with its last clamp; hdrify 1.2.1 in
//           double precision. Needle Engine, @needle-tools/engine 4.16.5. Insets and outsets of
//           three.js, Filament and Godot are those of Blender: E. Chow, AgX_LUT_Gen.
// In        scene-linear RGB; working primaries Rec.709 (agx_filament Rec.2020), D65; domain [0,
//           inf), negatives clamped at 0. agx_threejs passes negatives to its matrices and clamps
//           their result: domain (-inf, inf). All except agx_godot are constant above 16.29, 6.5
//           stops above mid gray, and below 10 stops under it.
// Out       agx_sobotka, agx_minimal: CODE VALUES of a 2.2 power, [0, 1], except for agx_minimal's
//           polynomial ends of -0.0023 and 0.9986 (order 6), 0.0029 and 0.982 (order 7), and looks
//           that saturate above 1. The others: display-linear RGB, 1.0 = display peak; agx_threejs
//           without the last clamp that three.js has since r161 (agx_threejs:r161), agx_godot44 and
//           agx_godot like the source: their last matrices put saturated colors below 0 or above 1.
// Kind      clamp, matrix, log and sigmoid, (matrix). agx_needle and the looks of agx_filament are
//           3D, because their luma is taken before the power. Monotone on the neutral axis: yes,
//           with two exceptions. Order 7 (agx_minimal:order7, agx_filament) dips in the lowest 2.5
//           % of its range. In agx_threejs and agx_godot44, the channels of grays reach the end of
//           the shaper one after another, so the last matrix subtracts 5e-6.
// Keeps     mid gray 0.18 -> code value 0.5 (agx_sobotka), display-linear 0.18 (agx_godot, and
//           agx_godot44 within 0.5 %).
// Differs   agx_sobotka computes the sigmoid in closed form; the configuration has a 4096-entry
//           table: 5e-8 apart, the rounding of the table. The sources floor log2 at 1e-10; here the
//           lower end of the shaper, 1.76e-4, is the floor. Godot's floor of 2e-10 on the input
//           stays. agx_filament's looks use the luma weights of Rec.709 although its primaries are
//           Rec.2020; the source does the same.
//           agx_needle: a value below 0 before the last power is 0, where the source has NaN.
//           Defects: the source of agx_minimal_clamped has no floor. Below the shaper its
//           polynomial leaves its range and shows 1e-6 as white; here the end of the shaper is the
//           floor.
// Check     mid gray 0.18 -> (0.500023782, 0.499993460, 0.499991575) (agx_sobotka), red 0.214548629
//           (agx_threejs), 0.214848193 (agx_filament, Rec.2020), red 0.179190952 (agx_godot44),
//           0.18 (agx_godot) (check_values.json).
#include <cmath>

#include "operators/agx_sigmoid.h"
#include "operators/color_modifiers.h"
#include "operators/family.h"

TONEWRIGHT_NAMESPACE_BEGIN
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

/// The shaper: log2 from 10 stops below to 6.5 stops above mid gray. Both sources print its ends
/// with seven digits (log2(0.18) - 10 = -12.4739312, log2(0.18) + 6.5 = 4.0260688), so those are
/// the ends.
constexpr double kLowest = -12.47393;
constexpr double kHighest = 4.026069;

/// Clamp of the normalized log value, in scene-linear. It is a separate stage, so that the curve
/// has no corners.
Stage limit_to_shaper() { return ClampStage{std::exp2(kLowest), std::exp2(kHighest)}; }

/// Scene-linear in the shaper's range -> [0, 1]; mid gray -> 10/16.5.
Expr normalized_log(const Expr& x) {
    return named("n", (log2(x) - kLowest) / (kHighest - kLowest));
}

/// Wrensch's fits of the sigmoid; order 7 is Filament's.
Expr polynomial6(const Expr& n) {
    const Expr n2 = named("n2", n * n);
    const Expr n4 = named("n4", n2 * n2);
    return 15.5 * n4 * n2 - 40.14 * n4 * n + 31.96 * n4 - 6.868 * n2 * n + 0.4298 * n2 +
           0.1191 * n - 0.00232;
}
Expr polynomial7(const Expr& n) {
    const Expr n2 = named("n2", n * n);
    const Expr n4 = named("n4", n2 * n2);
    const Expr n6 = named("n6", n4 * n2);
    return -17.86 * n6 * n + 78.01 * n6 - 126.7 * n4 * n + 92.06 * n4 - 28.72 * n2 * n +
           4.361 * n2 - 0.1718 * n + 0.002857;
}

/// ASC CDL without clamps, as OCIO 2 configs apply it, on code values.
Pipeline cdl(const Vector3& slope, double power, double saturation) {
    const Expr x = Expr::input();
    CurveStage curve = named("slope_power", curve_stage(x));
    for (std::size_t i = 0; i < 3; ++i)
        curve.f[i] = pow(slope[i] * x, power);
    // The clamp keeps the power's infinite slope at 0 out of the sigmoid's table.
    return {ClampStage{0, kInfinity}, curve,
            MatrixStage{saturation_matrix(saturation, kRec709Weights), "saturation"}};
}

Operator sobotka() {
    Operator op;
    op.id = "agx_sobotka";
    op.title = "AgX (Sobotka)";
    op.view = "AgX Sobotka";
    op.character =
        "low contrast, bright colors fade to white; keeps detail in saturated blues and neon "
        "colors where others clip";
    op.source = "T. Sobotka, AgX configuration for OpenColorIO (SB2383), 2022";
    op.license = "formula and constants only; none of its files is used";
    op.dialects = "AgX";
    op.negatives = kNegativesClampAtZero;
    op.output = OutputKind::code_value;
    op.code_power = 2.2;
    op.looks = {{"golden", "Golden", "warm: ASC CDL slope 1 0.9 0.5, power 0.8, saturation 1.3"},
                {"punchy", "Punchy", "darker and stronger: ASC CDL power 1.35, saturation 1.4"}};
    op.warnings = {"not Blender's AgX: it shows mid gray at code value 0.5, Blender at 0.46"};
    op.differences = {{DocumentedDifference::Kind::never_reaches_white, 0.193, "golden"},
                      {DocumentedDifference::Kind::exceeds_white, 1.06, "golden"},
                      {DocumentedDifference::Kind::tints_gray, 0.54, "golden"}};
    op.build = [](const Params& p) -> Pipeline {
        const AgxSigmoid sigmoid(10 / 16.5, 0.5, 2.0, 3.0, 3.25);
        Pipeline stages = {limit_to_positive(), MatrixStage{kInset, "inset"}, limit_to_shaper(),
                           named("contrast", curve_stage(sigmoid(normalized_log(Expr::input()))))};
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
        "AgX for shaders: polynomial sigmoid, and the inverse of the inset after it; more "
        "saturated than Sobotka's";
    op.source = "B. Wrensch, Minimal AgX Implementation, 2023; order 7: Filament ToneMapper.cpp";
    op.license = "MIT";
    op.dialects = "AgX";
    op.negatives = kNegativesClampAtZero;
    op.output = OutputKind::code_value;
    op.code_power = 2.2;
    op.parameters = {choice_parameter("order", {"6", "7"}, "6", "order of the polynomial")};
    op.presets = {{"order7", "Filament's polynomial of order 7", {{"order", "7"}}}};
    op.differences = {{DocumentedDifference::Kind::black, -0.0023, ""},
                      {DocumentedDifference::Kind::black, 0.0029, "order7"},
                      {DocumentedDifference::Kind::never_reaches_white, 0.997, ""},
                      {DocumentedDifference::Kind::never_reaches_white, 0.961, "order7"},
                      {DocumentedDifference::Kind::not_monotone, 0.00024, "order7"}};
    op.build = [](const Params& p) -> Pipeline {
        const Expr n = named("n", normalized_log(Expr::input()));
        const Expr f = p.choice("order") == "6" ? polynomial6(n) : polynomial7(n);
        return {limit_to_positive(), MatrixStage{kInset, "inset"}, limit_to_shaper(),
                named("contrast", curve_stage(f)), MatrixStage{kOutset, "outset"}};
    };
    return op;
}

/// The input of log2 is at most 1, so the upper 4 of the curve's 16.5 stops are never used.
Operator minimal_clamped() {
    Operator op =
        defect_of("agx_minimal", "agx_minimal_clamped",
                  "ByroRedux (matiaszanolli/ByroRedux c5663fe39, presentation.frag; issue 4578)",
                  "it limits scene-linear values to 1 before the logarithm, so everything above 1 "
                  "is shown at 0.59 of white");
    op.output = OutputKind::code_value;
    op.code_power = 2.2;
    op.differences = {{DocumentedDifference::Kind::black, -0.0023, ""},
                      {DocumentedDifference::Kind::never_reaches_white, 0.59, ""}};
    op.build = [](const Params&) -> Pipeline {
        return {limit_to_positive(), MatrixStage{kInset, "inset"},
                ClampStage{std::exp2(kLowest), 1},
                named("contrast", curve_stage(polynomial6(normalized_log(Expr::input())))),
                MatrixStage{kOutset, "outset"}};
    };
    return op;
}

/// Its rows do not sum to 1, but to 0.4, 1 and 1.
Operator matrix_and_power() {
    Operator op = defect_of(
        "agx_blender", "agx_matrix_and_power",
        "QtMeshEditor (fernandotonon/QtMeshEditor 251f723f, HdrTonemap.cpp; pull request 782)",
        "it has no logarithm and no sigmoid: it limits scene values to 1, applies a matrix that "
        "turns grays green, and raises the result to the power 1.35");
    op.differences = {{DocumentedDifference::Kind::never_reaches_white, 0.29, ""},
                      {DocumentedDifference::Kind::tints_gray, 0.42, ""}};
    op.build = [](const Params&) -> Pipeline {
        // clang-format off
        constexpr Matrix3 agx = {{{0.224282, 0.130789, 0.044929},
                                  {0.050223, 0.873461, 0.076316},
                                  {0.020833, 0.080745, 0.898422}}};
        // clang-format on
        return {ClampStage{0, 1}, MatrixStage{agx, "agx"},
                named("contrast", curve_stage(pow(Expr::input(), 1.35))), ClampStage{0, 1}};
    };
    return op;
}

/// Outset, then code values to display-linear. Values below 0 are clamped, because the power is
/// undefined there.
Pipeline outset_to_light() {
    return {MatrixStage{kAgxOutsetRec2020, "outset"}, ClampStage{0, kInfinity},
            named("to_light", curve_stage(pow(Expr::input(), 2.2)))};
}

Operator threejs() {
    Operator op;
    op.id = "agx_threejs";
    op.title = "AgX (three.js)";
    op.view = "AgX three.js";
    op.character =
        "Blender's matrices with Sobotka's curve: soft and pale; mid gray at display-linear 0.21, "
        "brighter than Blender's AgX";
    op.source = "three.js, tonemapping_pars_fragment: AgXToneMapping; after Filament";
    op.license = "MIT";
    op.dialects = "AgX";
    op.negatives =
        "kept by the matrix to Rec.2020 and the inset; then limited to the lower end of the "
        "shaper's range";
    op.parameters = {
        choice_parameter("clamp", {"no", "yes"}, "no",
                         "limit the result to [0, 1]; three.js does so since r161"),
        choice_parameter("matrices", {"printed", "exact"}, "printed",
                         "between Rec.709 and Rec.2020: the four digits that three.js prints, or "
                         "those of the primaries")};
    op.presets = {
        {"r161", "three.js r161 and later, gainmap-js: limited to [0, 1]", {{"clamp", "yes"}}},
        {"hdrify", "hdrify: exact matrices", {{"matrices", "exact"}}}};
    op.warnings = {"grays get darker by 5e-6 at scene-linear 16.3, where the shaper ends"};
    op.differences = {{DocumentedDifference::Kind::never_reaches_white, 0.997, ""},
                      {DocumentedDifference::Kind::not_monotone, 16, ""},
                      {DocumentedDifference::Kind::not_monotone, 0, "hdrify"}};
    op.build = [](const Params& p) -> Pipeline {
        // Rec.709 to Rec.2020 and its inverse, as the source prints them: 0.0113 is not the rounded
        // value.
        // clang-format off
        constexpr Matrix3 to_rec2020 = {{{0.6274, 0.3293, 0.0433},
                                         {0.0691, 0.9195, 0.0113},
                                         {0.0164, 0.0880, 0.8956}}};
        constexpr Matrix3 to_rec709 = {{{ 1.6605, -0.5876, -0.0728},
                                        {-0.1246,  1.1329, -0.0083},
                                        {-0.0182, -0.1006,  1.1187}}};
        // clang-format on
        const bool is_exact = p.choice("matrices") == "exact";
        const Matrix3 in = is_exact ? rgb_to_rgb(kRec709, kRec2020) : to_rec2020;
        const Matrix3 out = is_exact ? rgb_to_rgb(kRec2020, kRec709) : to_rec709;
        Pipeline stages = {
            MatrixStage{in, "to_rec2020"}, MatrixStage{kAgxInsetRec2020, "inset"},
            limit_to_shaper(),
            named("contrast", curve_stage(polynomial6(normalized_log(Expr::input()))))};
        stages = stages + outset_to_light() + Pipeline{MatrixStage{out, "to_rec709"}};
        if (p.choice("clamp") == "yes") stages.emplace_back(ClampStage{0, 1});
        return stages;
    };
    return op;
}

/// The look of Filament and Needle on code values: a CDL that saturates about the luma from before
/// slope and power, which no chain of curves and matrices can express.
CrossTalkStage look_about_first_luma(const Vector3& slope, double power, double saturation) {
    const std::array<Expr, 3> v = {Expr::input(0), Expr::input(1), Expr::input(2)};
    const Expr luma =
        kRec709Weights[0] * v[0] + kRec709Weights[1] * v[1] + kRec709Weights[2] * v[2];
    CrossTalkStage look = named("look", CrossTalkStage{v});
    for (std::size_t i = 0; i < 3; ++i)
        look.f[i] = luma + saturation * (pow(slope[i] * v[i], power) - luma);
    return look;
}

Operator needle() {
    Operator op;
    op.id = "agx_needle";
    op.title = "AgX (Needle Engine)";
    op.view = "AgX Needle";
    op.character =
        "the minimal AgX with a look of its own: more contrast and saturation; black is lifted";
    op.source = "Needle Engine, @needle-tools/engine 4.16.5, engine_tonemapping.ts: patchAGX";
    op.license = "published code; formula and constants only; none of its code is used";
    op.dialects = "AgX";
    op.negatives = "set to 0.001, like everything below it, before the first matrix";
    op.warnings = {"grays get darker by 1e-5 at scene-linear 16.3, where the shaper ends"};
    op.differences = {{DocumentedDifference::Kind::black, 4.1e-5, ""},
                      {DocumentedDifference::Kind::exceeds_white, 1.14, ""},
                      {DocumentedDifference::Kind::not_monotone, 16, ""}};
    op.build = [](const Params&) -> Pipeline {
        return {ClampStage{0.001, kHalfMax},
                MatrixStage{kInset, "inset"},
                limit_to_shaper(),
                named("contrast", curve_stage(polynomial6(normalized_log(Expr::input())))),
                ClampStage{0, 1},  // no effect: the polynomial stays inside above 0.001
                look_about_first_luma({1.05, 1.05, 1.05}, 1.10, 1.15),
                MatrixStage{kOutset, "outset"},
                ClampStage{0, kInfinity},
                named("to_light", curve_stage(pow(Expr::input(), 2.2)))};
    };
    return op;
}

Operator filament() {
    Operator op;
    op.id = "agx_filament";
    op.title = "AgX (Filament)";
    op.view = "AgX Filament";
    op.character =
        "AgX of three.js in Rec.2020 with the polynomial of order 7: white at display-linear 0.96";
    op.source = "Google Filament, ToneMapper.cpp: AgxToneMapper";
    op.license = "Apache-2.0; formula and constants only; none of its code is used";
    op.dialects = "AgX";
    op.negatives = kNegativesClampAtZero;
    op.working = kRec2020;
    op.looks = {{"golden", "Golden", "warm: slope 1 0.9 0.5, power 0.8, saturation 1.3"},
                {"punchy", "Punchy", "darker and stronger: power 1.35, saturation 1.4"}};
    // Measured with AP1, not derived: red of 0.156 0.938 0.094 is 0.370 - 0.334 - 0.011, with an
    // error of 1.65e-6 in the code value. Rounding before the matrices explains 1.34e-6. The tables
    // (curve entries, 2.7e-7; straight lines for the power 2.2, 3.3e-7) and the sums in the
    // matrices explain the rest. The worst case of all of them is 3.0e-6.
    op.bounds = {.ocio_cpu = 4e-7,
                 .lut3d = 2.4e-2,
                 .reason =
                     "matrices with cancellation amplify the rounding of the tables; the looks "
                     "need a 3D LUT, because they saturate about a luma from before their power"};
    // Punchy moves black below 0 before it is decoded, which removes the lifted black.
    op.differences = {{DocumentedDifference::Kind::black, 2.5e-6, ""},
                      {DocumentedDifference::Kind::black, 5.2e-5, "golden"},
                      {DocumentedDifference::Kind::black, 0, "punchy"},
                      {DocumentedDifference::Kind::crushes_black, 0.0020, "punchy"},
                      {DocumentedDifference::Kind::never_reaches_white, 0.961, ""},
                      {DocumentedDifference::Kind::never_reaches_white, -0.0052, "golden"},
                      {DocumentedDifference::Kind::never_reaches_white, 0.942, "punchy"},
                      {DocumentedDifference::Kind::exceeds_white, 1.24, "golden"},
                      {DocumentedDifference::Kind::not_monotone, 0.00021, "golden"},
                      {DocumentedDifference::Kind::tints_gray, 1, "golden"}};
    op.build = [](const Params& p) -> Pipeline {
        Pipeline stages = {
            limit_to_positive(), MatrixStage{kAgxInsetRec2020, "inset"}, limit_to_shaper(),
            named("contrast", curve_stage(polynomial7(normalized_log(Expr::input()))))};
        if (!p.look().empty()) {
            stages.push_back(ClampStage{0, 1});  // no effect: the polynomial stays inside
            stages.push_back(p.look() == "golden" ? look_about_first_luma({1, 0.9, 0.5}, 0.8, 1.3)
                                                  : look_about_first_luma({1, 1, 1}, 1.35, 1.4));
        }
        return stages + outset_to_light();
    };
    return op;
}

Operator godot44() {
    Operator op;
    op.id = "agx_godot44";
    op.title = "AgX (Godot 4.4)";
    op.view = "AgX Godot 4.4";
    op.character =
        "polynomial for Blender's sigmoid, decoded with the power 2.4: mid gray kept, soft "
        "highlights";
    op.source = "Godot Engine 4.4, tonemap.glsl: tonemap_agx";
    op.license = "MIT";
    op.dialects = "AgX";
    op.negatives = "set to 2e-10, before the first matrix";
    op.warnings = {"grays get darker by 4e-6 at scene-linear 16.3, where the shaper ends"};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, 1.0003, ""},
                      {DocumentedDifference::Kind::not_monotone, 16, ""}};
    op.build = [](const Params&) -> Pipeline {
        // clang-format off
        // Rec.709 to Rec.2020 and Blender's inset in one; its outset and the inverse in one.
        constexpr Matrix3 in = {{{0.544908138163631, 0.373779459598123, 0.081384976686408},
                                 {0.140440058840013, 0.754109598640138, 0.105433585368578},
                                 {0.088827411851915, 0.178877124650438, 0.732249999569484}}};
        constexpr Matrix3 out = {{{ 1.964550960273326, -0.855858451178075, -0.108867108268316},
                                  {-0.299322433909111,  1.326451074150236, -0.027084020983875},
                                  {-0.164368338060804, -0.238224640688606,  1.402665347143272}}};
        // clang-format on

        // Ends of the shaper with all digits; the other dialects print fewer.
        const double lowest = std::log2(0.18) - 10;
        const double highest = std::log2(0.18) + 6.5;
        const Expr n = named("n", (log2(Expr::input()) - lowest) / (highest - lowest));
        const Expr n2 = named("n2", n * n);
        const Expr n4 = named("n4", n2 * n2);
        const Expr code = named("code", 0.021 * n + 4.0111 * n2 - 25.682 * n2 * n + 70.359 * n4 -
                                            74.778 * n4 * n + 27.069 * n4 * n2);
        // Rounding may move n, and with it the code, below 0 at the lower end.
        return {ClampStage{2e-10, kHalfMax}, MatrixStage{in, "inset"},
                ClampStage{std::exp2(lowest), std::exp2(highest)},
                curve_stage(pow(max(code, 0), 2.4)), MatrixStage{out, "outset"}};
    };
    return op;
}

Operator godot() {
    Operator op;
    op.id = "agx_godot";
    op.title = "AgX (Godot 4.6)";
    op.view = "AgX Godot";
    op.character =
        "AgX without a logarithm: keeps mid gray; adjustable contrast, white and peak, suitable "
        "for HDR";
    op.source = "Godot Engine 4.6, tonemap.glsl: tonemap_agx; curve by allenwp";
    op.license = "MIT";
    op.warnings = {
        "equal to Godot's Forward+ and Mobile; Compatibility, which encodes without the linear "
        "segment of sRGB, differs by up to 3 8-bit code values near black"};
    op.dialects = "AgX";
    op.negatives = kNegativesClampAtZero;
    op.parameters = {
        number_parameter("contrast", "", 1.25, 0.1, 4, "power of the toe"),
        number_parameter("white", "scene-linear", 16.29, 2, 65504,
                         "lowest scene value shown at output_max"),
        number_parameter("output_max", "display-linear", 1, 0.2, 100,
                         "display peak divided by paper white"),
    };
    op.build = [](const Params& p) -> Pipeline {
        // clang-format off
        constexpr Matrix3 in = {{{0.544814746488245,  0.373787398372697, 0.0813978551390581},
                                 {0.140416948464053,  0.754137554567394, 0.105445496968552},
                                 {0.0888104196149096, 0.178871756420858, 0.732317823964232}}};
        constexpr Matrix3 out = {{{ 1.96488741169489,  -0.855988495690215, -0.108898916004672},
                                  {-0.299313364904742,  1.3263979646198,   -0.0270845997150571},
                                  {-0.164352742528393, -0.238183969428088,  1.40253671195648}}};
        // clang-format on
        constexpr double cross = 0.18;  // input and output where toe and shoulder meet
        const Expr contrast = p.expr("contrast");
        const Expr output_max = p.expr("output_max");
        const Expr a = named("a", (1 / cross - 1) * pow(cross, contrast));
        const Expr toe_end = named("toe_end", pow(cross, contrast) + a);
        const Expr slope =
            named("slope", contrast * pow(cross, contrast - 1) * a / (toe_end * toe_end));
        const Expr height = named("height", output_max - cross);
        const Expr length = named("length", p.expr("white") - cross);
        const Expr w = named("w", length * length / height * slope);

        const Expr x = Expr::input();
        const Expr t = named("t", pow(x, contrast));
        const Expr s = named("s", max(x - cross, 0));  // below the crossing the shoulder has a pole
        const Expr shoulder =
            named("shoulder", slope * s * (1 + s / w) / (1 + slope * s / height) + cross);
        return {limit_to_positive(), MatrixStage{in, "inset"},
                curve_stage(select(less(x, cross), t / (t + a), shoulder)), clamp_stage(output_max),
                MatrixStage{out, "outset"}};
    };
    return op;
}

}  // namespace

std::vector<Operator> define_agx() {
    return {sobotka(), minimal(), threejs(),         filament(),        godot44(),
            godot(),   needle(),  minimal_clamped(), matrix_and_power()};
}

TONEWRIGHT_NAMESPACE_END
