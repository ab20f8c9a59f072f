// SPDX-License-Identifier: Apache-2.0
//
// Gran Turismo, Hajime Uchimura 2017: three joined parts, toe, straight line, shoulder.
//
// Source    H. Uchimura, "HDR Theory and Practice", CEDEC 2017, slides 130-150.
// In        scene-linear RGB, working primaries Rec.709, D65; domain [0, 65504], negatives: clamped
//           at 0 (the toe's power has no value there).
// Out       display-linear RGB, 1.0 = paper white; range [b, P].
// Kind      per channel; monotone on the neutral axis: yes.
// Keeps     f(0) = b; straight line of slope a through (m, m).
// Differs   nowhere: the unused helpers L0, L1 of most ports are left out, and the shoulder is
//           evaluated from its own start on, which it has weight 0 before.
// Check     mid grey 0.18 -> 0.178994806 (python_check/operators/uchimura.py).
#include "base/format_number.h"
#include "operators/family.h"

TONEWRIGHT_NAMESPACE_BEGIN

std::vector<Operator> define_uchimura() {
    Operator op;
    op.id = "uchimura";
    op.title = "Gran Turismo (Uchimura 2017)";
    op.view = "Gran Turismo";
    op.character = "mid tones untouched, short toe and exponential shoulder; clean and bright";
    op.source = "H. Uchimura, HDR Theory and Practice, CEDEC 2017";
    op.licence = "published formula";
    op.negatives = kNegativesClampAtZero;
    op.dialects = "Gran Turismo";
    // Slope 0 and the ends of m and l make the formula divide by 0: the intervals stop short of
    // them.
    op.parameters = with_apply(
        "channels",
        {display_parameter(
             number_parameter("max_brightness", "display-linear", 1, 1, 100,
                              "P: display peak over paper white"),
             [](const DisplayFacts& display) { return shortest(display.peak / 100); }),
         number_parameter("contrast", "", 1, 0.01, 5, "a: slope of the straight part"),
         number_parameter("linear_start", "scene-linear", 0.22, 0.01, 0.99,
                          "m: where the straight part starts"),
         number_parameter("linear_length", "", 0.4, 0.01, 0.99, "l: length of the straight part"),
         number_parameter("black_tightness", "", 1.33, 1, 3, "c: power of the toe"),
         number_parameter("pedestal", "display-linear", 0, 0, 1, "b: light at black")});
    op.presets = {{"hdr",
                   "for a display with ten times the light of paper white",
                   {{"max_brightness", "10"}}}};
    op.warnings = {"with max_brightness above 1 an SDR display clips at paper white"};
    op.deviations = {{DocumentedDifference::Kind::exceeds_white, 10, "hdr"}};
    op.peak = [](const Params& params) { return params.number("max_brightness"); };
    op.build = [](const Params& params) -> Pipeline {
        const Expr P = params.expr("max_brightness");
        const Expr a = params.expr("contrast");
        const Expr m = params.expr("linear_start");
        const Expr l = params.expr("linear_length");
        const Expr c = params.expr("black_tightness");
        const Expr b = params.expr("pedestal");

        const Expr l0 = (P - m) * l / a;
        const Expr S0 = m + l0;
        const Expr S1 = m + a * l0;
        const Expr C2 = a * P / (P - S1);

        const Expr x = Expr::input();
        const Expr w0 = 1 - smoothstep(0, m, x);
        const Expr w2 = less_equal(S0, x);  // step(S0, x)
        const Expr w1 = 1 - w0 - w2;
        const Expr toe = m * pow(x / m, c) + b;
        const Expr line = m + a * (x - m);
        const Expr shoulder = P - (P - S1) * exp(-(C2 * (max(x, S0) - S0) / P));
        return tone_curve_pipeline({.f = toe * w0 + line * w1 + shoulder * w2}, params);
    };
    return {op};
}

TONEWRIGHT_NAMESPACE_END
