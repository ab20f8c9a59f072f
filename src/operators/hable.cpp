// SPDX-License-Identifier: Apache-2.0
//
// John Hable's curves: the rational curve of Uncharted 2 with two sets of constants, and the
// piecewise curve of 2017.
//
// Source    J. Hable, "Filmic Tonemapping Operators", filmicworlds.com, 2010-05-05, with the
//           constants of that page (A .15 ... W 11.2, exposure bias 2): hable. J. Hable, "Uncharted
//           2: HDR Lighting", GDC 2010 (A .22 B .30 E .01): hable_gdc; also in Godot's
//           tonemap.glsl, and, times 1.25, in PlayCanvas 2.23.3 under the name TONEMAP_HEJL. Whites
//           of other engines: postprocessing 6.39.6, ray-tracing-renderer 0.10.15, Mapbox GL JS
//           3.32.0. unity_neutral: @galacean/engine-core 1.6.13, whose shader names Unity's curve.
//           J. Hable, "Filmic Tonemapping with Piecewise Power Curves",
//           filmicworlds.com, 2017-03-26, and github.com/johnhable/fw-public (CC0):
//           hable_piecewise.
// In        scene-linear RGB, working primaries Rec.709, D65; domain [0, 65504], negatives clamped
//           at 0.
// Out       display-linear RGB, 1.0 = display peak; hable [0, 1.287) with the defaults,
//           hable_piecewise up to (1 + overshoot)/(value at white).
// Kind      per channel; monotone on the neutral axis: yes.
// Keeps     f(0) = 0. hable: f(white/exposure_bias) = 1; hable_piecewise: 1 at the white given by
//           shoulder_strength, and the identity up to it with the defaults.
// Differs   hable: nowhere. As on the page, the bias does not scale the white W: with the bias of
//           2, scene-linear 5.6 is white. (Godot scales both, so its preset has white 2 for a scene
//           white of 1; some ports apply the bias to the output.) unity_neutral: the engine
//           rounds the factor 1/h(5.3) on the result to 1.31338, the difference is 6e-6. In
//           postprocessing and ray-tracing-renderer a clamp to [0, 1] follows.
//           hable_piecewise: a toe that ends below 2^-100 counts as no toe (the source takes the
//           logarithm of 0). The slopes at the joints of the segments are limited to [2^-24, 2^24];
//           the source has 0 and infinity for a joint at black with a gamma other than 1. A
//           shoulder that aims a million times above white is an error, because no digits of the
//           curve remain. The source's floors of 1e-5 on the output at a joint, and its slope of 1
//           for a linear segment without length, are kept.
// Check     mid gray 0.18 -> 0.128338449 (hable), 0.305855436 (hable:godot), 0.0664512855
//           (hable_piecewise:film) (python_check/operators/hable.py).
#include <algorithm>
#include <cmath>
#include <span>

#include "base/format_number.h"
#include "operators/family.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Hable {
    Expr A, B, C, D, E, F;

    [[nodiscard]] Expr operator()(const Expr& x) const {
        return (x * (A * x + C * B) + D * E) / (x * (A * x + B) + D * F) - E / F;
    }
};

/// @param scene  the input of the curve, a function of input 0.
Pipeline hable_pipeline(const Hable& h, const Expr& scene, const Params& p) {
    const Expr at_white = named("at_white", h(p.expr("white")));
    if (fails(less(0, at_white))) {
        throw Error("curve at white is " + shortest(at_white.value()) +
                    "; expected above 0 (toe_numerator below toe_denominator, larger white)");
    }
    return tone_curve_pipeline({.f = h(scene) / at_white}, p);
}

ParameterSpec white() {
    return number_parameter(
        "white", "scene-linear, after the bias", 11.2, 0.1, kHalfMax,
        "W of the formula: scene value after the bias that is shown as display white");
}
ParameterSpec exposure_bias(double value) {
    return number_parameter("exposure_bias", "", value, 0.01, 100, "factor on the scene value");
}

Operator uncharted() {
    Operator op;
    op.id = "hable";
    op.title = "Hable (Uncharted 2)";
    op.view = "Hable";
    op.character =
        "strong toe, long soft shoulder: high contrast and dark, the look of games in 2010";
    op.source = "J. Hable, Filmic Tonemapping Operators, filmicworlds.com, 2010-05-05";
    op.license = "published formula (code on the page: public domain)";
    op.negatives = kNegativesClampAtZero;
    op.dialects = "Hable";
    // D and F stay away from 0, because their product is the curve's denominator at black.
    op.parameters = with_apply(
        "channels",
        {number_parameter("shoulder_strength", "", 0.15, 0.01, 1, "A of the formula"),
         number_parameter("linear_strength", "", 0.50, 0.01, 1, "B of the formula"),
         number_parameter("linear_angle", "", 0.10, 0, 1, "C of the formula"),
         number_parameter("toe_strength", "", 0.20, 0.01, 1, "D of the formula"),
         number_parameter("toe_numerator", "", 0.02, 0, 0.9, "E of the formula; below F"),
         number_parameter("toe_denominator", "", 0.30, 0.01, 1, "F of the formula"), white(),
         exposure_bias(2)});
    op.presets = {{"gdc",
                   "constants of the GDC 2010 slides, without a bias",
                   {{"shoulder_strength", "0.22"},
                    {"linear_strength", "0.3"},
                    {"toe_numerator", "0.01"},
                    {"exposure_bias", "1"}}},
                  {"godot",
                   "Godot's Filmic (Forward+, Mobile) with its white at 1; white is twice Godot's",
                   {{"shoulder_strength", "0.22"},
                    {"linear_strength", "0.3"},
                    {"toe_numerator", "0.01"},
                    {"white", "2"}}},
                  {"no_bias",
                   "without the bias: Filmic of PlayCanvas, tonemapUncharted2 of lygia",
                   {{"exposure_bias", "1"}}},
                  {"postprocessing",
                   "UNCHARTED2 of postprocessing: white 4, no bias",
                   {{"exposure_bias", "1"}, {"white", "4"}}},
                  {"ray_tracing_renderer",
                   "Uncharted 2 of ray-tracing-renderer: white 5, no bias",
                   {{"exposure_bias", "1"}, {"white", "5"}}},
                  {"mapbox",
                   "sky of Mapbox GL JS: white 1000, no bias",
                   {{"exposure_bias", "1"}, {"white", "1000"}}},
                  {"unity_neutral",
                   "Neutral of Galacean, after Unity's",
                   {{"shoulder_strength", "0.2"},
                    {"linear_strength", "0.29"},
                    {"linear_angle", "0.24"},
                    {"toe_strength", "0.272"},
                    {"white", "5.3"},
                    {"exposure_bias", "1.31338"}}}};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, 1.3, ""},
                      {DocumentedDifference::Kind::exceeds_white, 1.1, "gdc"},
                      {DocumentedDifference::Kind::exceeds_white, 1.7, "godot"},
                      {DocumentedDifference::Kind::exceeds_white, 1.8, "postprocessing"},
                      {DocumentedDifference::Kind::exceeds_white, 1.65, "ray_tracing_renderer"},
                      {DocumentedDifference::Kind::exceeds_white, 1.01, "mapbox"},
                      {DocumentedDifference::Kind::exceeds_white, 1.23, "unity_neutral"}};
    op.build = [](const Params& p) -> Pipeline {
        return hable_pipeline({.A = p.expr("shoulder_strength"),
                               .B = p.expr("linear_strength"),
                               .C = p.expr("linear_angle"),
                               .D = p.expr("toe_strength"),
                               .E = p.expr("toe_numerator"),
                               .F = p.expr("toe_denominator")},
                              p.expr("exposure_bias") * Expr::input(), p);
    };
    return op;
}

Operator bias_on_result() {
    Operator op = defect_of("hable", "hable_bias_on_result",
                            "Tonemapper (tizian/tonemapper 5215acc3, HableFilmicOperator.cpp)",
                            "it applies the exposure bias of 2 to the result instead of the scene "
                            "value, so it clips scene values above 2.05");
    op.build = [](const Params&) -> Pipeline {
        const Hable curve{.A = 0.15, .B = 0.50, .C = 0.10, .D = 0.20, .E = 0.02, .F = 0.30};
        return {limit_to_positive(), curve_stage(2.0 * curve(Expr::input()) / curve(11.2)),
                ClampStage{0, 1}};
    };
    return op;
}

Operator gdc() {
    Operator op;
    op.id = "hable_gdc";
    op.title = "Hable (GDC 2010)";
    op.view = "Hable GDC";
    op.character = "Hable with the constants of the slides: darker, with more contrast in the toe";
    op.source = "J. Hable, Uncharted 2: HDR Lighting, GDC 2010";
    op.license = "published formula";
    op.negatives = kNegativesClampAtZero;
    op.dialects = "Hable";
    op.parameters = with_apply(
        "channels", {white(), exposure_bias(1),
                     number_parameter("black", "scene-linear", 0, 0, 0.1,
                                      "scene value, after the bias, that is subtracted first")});
    // The curve is 0.8 at this white. PlayCanvas multiplies it by 1.25.
    op.presets = {{"playcanvas",
                   "PlayCanvas, TONEMAP_HEJL, which is not a curve of Hejl",
                   {{"white", "6.2107773060570395"}, {"black", "0.004"}}}};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, 1.1, ""},
                      {DocumentedDifference::Kind::exceeds_white, 1.21, "playcanvas"},
                      {DocumentedDifference::Kind::crushes_black, 0.004, "playcanvas"}};
    op.bounds.ocio_cpu = op.bounds.ocio_gpu = 1e-5;
    op.bounds.reason = "with `black`, the slope jumps there, between two half floats";
    op.build = [](const Params& p) -> Pipeline {
        const Expr black = p.expr("black");
        const Expr scene = p.expr("exposure_bias") * Expr::input();
        return hable_pipeline({.A = 0.22, .B = 0.30, .C = 0.10, .D = 0.20, .E = 0.01, .F = 0.30},
                              select(equal(black, 0), scene, max(scene - black, 0)), p);
    };
    return op;
}

/// base^exponent, 0 for a base up to 2^-100, because the slope of a power below 1 is infinite at 0.
Expr power(const Expr& base, double exponent) {
    return select(less(0x1p-100, base), pow(base, exponent), 0);
}

/// (1 - t)^exponent for an exponent of 1 or more, 0 below e^-69 = 1e-30. The rounding error of 1 -
/// t, which a large exponent would amplify, cancels in the quotient.
Expr power_of_1_minus(const Expr& t, double exponent) {
    const Expr u = named("u", 1 - t);
    const Expr log_u = named("log_u", select(equal(u, 1), -t, t * (log(u) / (1 - u))));
    return select(less(-69, exponent * log_u), exp(exponent * log_u), 0);
}

/// Three powers of the scene value x: a toe from black up to x0, then the linear segment to the
/// power of gamma, and a shoulder from x1. The names are those of the source.
Expr piecewise_curve(const Params& p) {
    const double shoulder_strength = p.number("shoulder_strength");
    const double angle = p.number("shoulder_angle");
    const double gamma = p.number("gamma");

    // Points of the curve from the user's parameters, before gamma. The linear segment has slope 1.
    const double x0 = std::pow(p.number("toe_length"), 2.2) / 2;
    const double y0 = (1 - p.number("toe_strength")) * x0;
    const double remaining = 1 - y0;
    const double straight = (1 - p.number("shoulder_length")) * remaining;
    const double x1 = x0 + straight;
    const double y1 = y0 + straight;
    const double white = x0 + remaining + std::exp2(shoulder_strength) - 1;
    const double overshoot_x = 2 * angle * shoulder_strength;  // in units of white
    const double overshoot_y = std::pow(1 + 0.5 * angle * shoulder_strength, gamma) - 1;

    // In normalized x/white: slope m of the linear segment, and slope of the curve at both of its
    // ends.
    const double m = straight == 0 ? 1 : white;
    const auto slope = [&](double y) {
        return std::clamp(gamma * m * std::pow(y, gamma - 1), 0x1p-24, 0x1p24);
    };
    const double toe_y = std::max(1e-5, std::pow(y0, gamma));
    const double shoulder_y = std::max(1e-5, std::pow(y1, gamma));

    const double X = (white - x1) / white + overshoot_x;  // from start to end of the shoulder
    const double Y = 1 + overshoot_y - shoulder_y;
    const double shoulder_exponent = slope(y1) * X / Y;
    const auto shoulder = [&](const Expr& x) {
        const Expr falling =
            named("falling", shoulder_exponent < 1
                                 ? power((1 + overshoot_x - x / white) / X, shoulder_exponent)
                                 : power_of_1_minus((x - x1) / (X * white), shoulder_exponent));
        return 1 + overshoot_y - Y * falling;
    };
    const double at_white = shoulder(white).value();
    if (!(1 + overshoot_y < 1e6 * at_white)) {
        throw Error("shoulder_angle is " + shortest(angle) +
                    "; expected less with this gamma, shoulder_strength and shoulder_length: the "
                    "shoulder would aim at " +
                    shortest((1 + overshoot_y) / at_white) + " times the light of white");
    }

    const Expr x = Expr::input();
    Expr f = shoulder(max(x, x1));
    f = named("shoulder", f);
    if (straight > 0) {
        f = named("straight_or_shoulder",
                  select(less(x, x1), power(min(x, x1) - (x0 - y0), gamma), f));
    }
    if (x0 > 0x1p-100) {
        const double toe_exponent = slope(y0) * (x0 / white) / toe_y;
        const Expr toe = named("toe", toe_y * power(min(x, x0) / x0, toe_exponent));
        f = select(less(x, x0), toe, f);
    }
    return select(less(0x1p-100, x), f / at_white, 0);
}

Operator piecewise() {
    Operator op;
    op.id = "hable_piecewise";
    op.title = "Hable piecewise power curve";
    op.view = "Hable Piecewise";
    op.character = "manual toe, linear segment and shoulder; a clip at 1 by default";
    op.source =
        "J. Hable, Filmic Tonemapping with Piecewise Power Curves, filmicworlds.com, 2017-03-26; "
        "github.com/johnhable/fw-public";
    op.license = "CC0-1.0";
    op.negatives = kNegativesClampAtZero;
    op.dialects = "Hable";
    op.parameters = with_apply(
        "channels",
        fixed_parameters(
            {number_parameter("toe_strength", "", 0, 0, 1,
                              "strength of the toe (0: no toe, 1: black up to the end of the toe)"),
             number_parameter(
                 "toe_length", "", 0.5, 0, 1,
                 "length of the toe: its 2.2 power is twice the scene value at the end of the toe"),
             number_parameter("shoulder_strength", "stops", 0, 0, 16,
                              "stops by which the scene value of white increases"),
             number_parameter("shoulder_length", "", 0.5, 1e-5, 1,
                              "share of the range above the toe that the shoulder covers"),
             number_parameter("shoulder_angle", "", 0, 0, 1,
                              "how far above white the shoulder aims; values above 0 exceed white"),
             number_parameter("gamma", "", 1, 0.1, 10, "power on the output of the curve"),
             display_parameter(
                 number_parameter(
                     "max_brightness", "display-linear", 1, 1, 100,
                     "P: display peak divided by paper white; the curve f becomes P f(x/P)"),
                 [](const DisplayFacts& display) { return shortest(display.peak / 100); })}));
    op.peak = [](const Params& params) { return params.number("max_brightness"); };
    op.presets = {{"film",
                   "toe, two stops of highlights and a shoulder that exceeds white",
                   {{"toe_strength", "0.5"},
                    {"toe_length", "0.5"},
                    {"shoulder_strength", "2"},
                    {"shoulder_length", "0.5"},
                    {"shoulder_angle", "1"}}},
                  {"soft",
                   "short toe, four stops of highlights",
                   {{"toe_strength", "0.2"},
                    {"toe_length", "0.3"},
                    {"shoulder_strength", "4"},
                    {"shoulder_length", "0.7"},
                    {"shoulder_angle", "0.4"}}}};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, 1.1, "film"},
                      {DocumentedDifference::Kind::exceeds_white, 1.0, "soft"}};
    op.build = [](const Params& p) -> Pipeline {
        const double brightness = p.number("max_brightness");
        const Expr x = Expr::input() / brightness;
        const Expr f = brightness * substitute(piecewise_curve(p), std::span(&x, 1));
        return tone_curve_pipeline({.f = f}, p);
    };
    return op;
}

}  // namespace

std::vector<Operator> define_hable() { return {uncharted(), gdc(), piecewise(), bias_on_result()}; }

TONEWRIGHT_NAMESPACE_END
