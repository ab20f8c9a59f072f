// SPDX-License-Identifier: Apache-2.0
//
// Gran Turismo, Hajime Uchimura 2017: toe, linear segment and shoulder.
//
// Source    H. Uchimura, "HDR Theory and Practice", CEDEC 2017, slides 130-150.
// In        scene-linear RGB, working primaries Rec.709, D65; domain [0, 65504], negatives clamped
//           at 0 (the toe's power is undefined below).
// Out       display-linear RGB, 1.0 = paper white; range [b, P].
// Kind      per channel; monotone on the neutral axis: yes.
// Keeps     f(0) = b; a line of slope a through (m, m).
// Differs   nowhere: the unused helpers L0, L1 of most ports are left out, and the shoulder is
//           evaluated only from its start, because its weight is 0 below.
// Check     mid gray 0.18 -> 0.178994806 (python_check/operators/uchimura.py).
#include "base/format_number.h"
#include "operators/family.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// @param l0  length of the linear segment
Expr curve(const Expr& P, const Expr& a, const Expr& m, const Expr& l0, const Expr& c,
           const Expr& b) {
    const Expr S0 = named("S0", m + l0);
    const Expr S1 = named("S1", m + a * l0);
    const Expr C2 = named("C2", a * P / (P - S1));

    const Expr x = Expr::input();
    const Expr w0 = named("w0", 1 - smoothstep(0, m, x));
    const Expr w2 = named("w2", less_equal(S0, x));  // step(S0, x)
    const Expr w1 = named("w1", 1 - w0 - w2);
    const Expr toe = named("toe", m * pow(x / m, c) + b);
    const Expr line = named("straight", m + a * (x - m));
    const Expr shoulder = named("shoulder", P - (P - S1) * exp(-(C2 * (max(x, S0) - S0) / P)));
    return toe * w0 + line * w1 + shoulder * w2;
}

Operator gran_turismo() {
    Operator op;
    op.id = "uchimura";
    op.title = "Gran Turismo (Uchimura 2017)";
    op.view = "Gran Turismo";
    op.character = "unchanged midtones, short toe and exponential shoulder; clean and bright";
    op.source = "H. Uchimura, HDR Theory and Practice, CEDEC 2017";
    op.license = "published formula";
    op.negatives = kNegativesClampAtZero;
    op.dialects = "Gran Turismo";
    // Slope 0 and the ends of m and l make the formula divide by 0, so the ranges exclude them.
    op.parameters = with_apply(
        "channels",
        {display_parameter(
             number_parameter("max_brightness", "display-linear", 1, 1, 100,
                              "P: display peak divided by paper white"),
             [](const DisplayFacts& display) { return shortest(display.peak / 100); }),
         number_parameter("contrast", "", 1, 0.01, 5, "a: slope of the linear segment"),
         number_parameter("linear_start", "scene-linear", 0.22, 0.01, 0.99,
                          "m: start of the linear segment"),
         number_parameter("linear_length", "", 0.4, 0.01, 0.99, "l: length of the linear segment"),
         number_parameter("black_tightness", "", 1.33, 1, 3, "c: power of the toe"),
         number_parameter("pedestal", "display-linear", 0, 0, 1, "b: output at black")});
    op.presets = {
        {"hdr", "HDR display with a peak of ten times paper white", {{"max_brightness", "10"}}}};
    op.warnings = {"SDR displays clip at paper white if max_brightness is above 1"};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, 10, "hdr"}};
    op.peak = [](const Params& params) { return params.number("max_brightness"); };
    op.build = [](const Params& params) -> Pipeline {
        const Expr P = params.expr("max_brightness");
        const Expr a = params.expr("contrast");
        const Expr m = params.expr("linear_start");
        const Expr l = params.expr("linear_length");
        const Expr c = params.expr("black_tightness");
        const Expr b = params.expr("pedestal");

        return tone_curve_pipeline({.f = curve(P, a, m, (P - m) * l / a, c, b)}, params);
    };
    return op;
}

/// The linear segment ends at 2.17, so the shoulder begins above the display's peak.
Operator misprinted() {
    Operator op = defect_of(
        "uchimura", "uchimura_misprinted",
        "gran_turismo.h of tizian/tonemapper pull request 3 (and shadertoy.com/view/Xstyzn)",
        "it divides by the length of the linear segment instead of multiplying, so it has no "
        "shoulder and clips scene values above 1");
    op.build = [](const Params&) -> Pipeline {
        const double P = 1, a = 1, m = 0.22, l = 0.4, c = 1.33, b = 0;
        // The shoulder is unbounded. 4 is far above its start and below its overflow.
        return {ClampStage{0, 4}, curve_stage(curve(P, a, m, (P - m) / l / a, c, b)),
                ClampStage{0, 1}};
    };
    return op;
}

}  // namespace

std::vector<Operator> define_uchimura() { return {gran_turismo(), misprinted()}; }

TONEWRIGHT_NAMESPACE_END
