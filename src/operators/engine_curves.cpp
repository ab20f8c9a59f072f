// SPDX-License-Identifier: Apache-2.0
//
// Curves of single engines: Babylon.js' contrast, nanogl-pbr's approximation of the sRGB curve, and
// luma.gl's tone mapping for HDR canvases.
//
// Source    babylon_contrast: Babylon.js, @babylonjs/core 9.35.0, applyImageProcessing. nanogl_tb:
//           nanogl-pbr 3.0.0-beta.16, tonemap.glsl, GAMMA_TB. luma_gl: luma.gl, @luma.gl/effects
//           9.4.2, toneMapping; its rational is that of K. Narkowicz, "ACES Filmic Tone Mapping
//           Curve", 2016. All were executed.
// In        scene-linear RGB, working primaries Rec.709, D65; domain [0, 65504], negatives clamped
//           at 0.
// Out       babylon_contrast: CODE VALUES of a 2.2 power, [0, 1] up to a contrast of 2. nanogl_tb:
//           CODE VALUES of an sRGB display, without an upper bound. luma_gl: display-linear RGB,
//           1.0 = display white, [0, maximum_luminance].
// Kind      babylon_contrast, nanogl_tb per channel; luma_gl per channel, then a factor that
// depends
//           on the largest channel, so a bright channel brightens the others. Monotone on the
//           neutral axis: yes.
// Keeps     0 -> 0, except that a contrast below 1 lifts black. nanogl_tb: 1 -> 1.
// Differs   babylon_contrast is the image processing without a tone curve; Babylon.js applies the
//           contrast after any of its curves. nanogl_tb: the engine does not clamp; here the
//           display does.
// Check     mid gray 0.18 -> code value 0.448391 (babylon_contrast), code value 0.458938
//           (nanogl_tb); 1 -> 1.281858 (luma_gl, maximum_luminance 4)
//           (engines executed; python_check/operators/engine_curves.py).
#include "base/format_number.h"
#include "operators/family.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

Operator babylon_contrast() {
    constexpr double kCodePower = 2.2;
    Operator op;
    op.id = "babylon_contrast";
    op.title = "Contrast (Babylon.js)";
    op.view = "Babylon Contrast";
    op.character =
        "the scene, clipped at 1, with an S-curve on code values: more contrast about the middle";
    op.source = "Babylon.js, @babylonjs/core 9.35.0, applyImageProcessing: contrast";
    op.license = "Apache-2.0; formula and constants only; none of its code is used";
    op.negatives = kNegativesClampAtZero;
    op.output = OutputKind::code_value;
    op.code_power = kCodePower;
    op.parameters = {number_parameter(
        "contrast", "", 1.5, 0, 4,
        "contrast of the engine (1: unchanged; below: towards 0.5; above: towards an S-curve)")};
    op.warnings = {"above a contrast of 2, dark grays are black and grays near white get darker"};
    op.build = [](const Params& p) -> Pipeline {
        const Expr contrast = p.expr("contrast");
        const Expr v = named("code", pow(Expr::input(), 1 / kCodePower));
        const Expr flat = named("flat", mix(0.5, v, contrast));
        const Expr steep = named("steep", mix(v, v * v * (3 - 2 * v), contrast - 1));
        return {ClampStage{0, 1}, curve_stage(max(select(less(contrast, 1), flat, steep), 0))};
    };
    return op;
}

Operator nanogl_tb() {
    Operator op;
    op.id = "nanogl_tb";
    op.title = "GAMMA_TB (nanogl-pbr)";
    op.view = "nanogl TB";
    op.character =
        "no tone curve: an approximation of the sRGB curve, 0.02 from it, under the name ToneMapTB";
    op.source = "nanogl-pbr 3.0.0-beta.16, tonemap.glsl: GAMMA_TB";
    op.license = "GPL-2.0; formula and constants only; none of its code is used";
    op.negatives = kNegativesClampAtZero;
    op.output = OutputKind::code_value;
    op.display = [](const Params&) -> std::string { return "srgb"; };
    op.differences = {{DocumentedDifference::Kind::exceeds_white, kInfinity, ""}};
    op.bounds.ocio_cpu = op.bounds.ocio_gpu = 1e-4;
    op.bounds.reason = "infinite slope at black, and half floats end at 6e-8";
    op.build = [](const Params&) -> Pipeline {
        const Expr c = Expr::input();
        const Expr root = named("root", sqrt(c));
        return {limit_to_positive(), curve_stage((root - root * c) + c * (0.4672 * c + 0.5328))};
    };
    return op;
}

Operator luma_gl() {
    Operator op;
    op.id = "luma_gl";
    op.title = "luma.gl tone mapping";
    op.view = "luma.gl";
    op.character =
        "Narkowicz's curve, whose highlights rise to the peak of an HDR canvas; exactly his curve "
        "on SDR";
    op.source = "luma.gl, @luma.gl/effects 9.4.2, toneMapping";
    op.license = "MIT; formula and constants only; none of its code is used";
    op.negatives = kNegativesClampAtZero;
    op.dialects = "ACES";
    op.parameters = fixed_parameters({display_parameter(
        number_parameter("maximum_luminance", "display-linear", 1, 1, 100,
                         "display peak divided by paper white"),
        [](const DisplayFacts& display) { return shortest(display.peak / 100); })});
    op.peak = [](const Params& params) { return params.number("maximum_luminance"); };
    op.presets = {{"hdr", "an HDR canvas of four times white", {{"maximum_luminance", "4"}}}};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, 4, "hdr"}};
    op.bounds = {.lut3d = 0.03,
                 .reason =
                     "the steep rise of highlights depends on the largest channel, whose "
                     "corners no 3D LUT has"};
    op.build = [](const Params& p) -> Pipeline {
        const double peak = p.number("maximum_luminance");
        const auto narkowicz = [](const Expr& x) {
            return x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
        };
        if (peak == 1)
            return {limit_to_positive(), curve_stage(narkowicz(Expr::input())), ClampStage{0, 1}};
        const std::array<Expr, 3> c = {Expr::input(0), Expr::input(1), Expr::input(2)};
        const Expr largest = named("largest", max(max(c[0], c[1]), c[2]));
        const Expr weight = named("highlight_weight", smoothstep(0.72, 1.7, largest));
        const Expr scale = named("extended_scale", mix(1, peak, weight));
        CrossTalkStage stage{c};
        for (Expr& channel : stage.f)
            channel = narkowicz(channel) * scale;
        return {limit_to_positive(), stage, ClampStage{0, peak}};
    };
    return op;
}

}  // namespace

std::vector<Operator> define_engine_curves() {
    return {babylon_contrast(), nanogl_tb(), luma_gl()};
}

TONEWRIGHT_NAMESPACE_END
