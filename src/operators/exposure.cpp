// SPDX-License-Identifier: Apache-2.0
//
// Elementary curves: a division, an exponential, two logarithms, a power. Each uses one statistic
// of the picture: its mean or its maximum.
//
// Source    linear: common practice, "maximum division" where the divisor is the picture's maximum.
//           exponential, logarithmic, exponentiation: as in T. Zeltner, "Tone Mapper"
//           (github.com/tizian/tonemapper), 2015; the presets of exponential: Babylon.js,
//           @babylonjs/core 9.35.0 (image processing and TonemapPostProcess), Orillusion 0.9.2,
//           VTK 9.6.2. log_tonemap: T. Madams, "Why Reinhard desaturates
//           my blacks", imdoingitwrong.wordpress.com, 2010-08-19, comment 9.
// In        scene-linear RGB, working primaries Rec.709, D65; domain [0, 65504], negatives: clamped
//           at 0.
// Out       display-linear RGB, 1.0 = display peak. linear [0, 1]; exponential [0, 1); the others
//           are 1 at `maximum` or `limit` and keep rising above it.
// Kind      per channel (linear) or luminance, as `apply` says; monotone on the neutral axis: yes.
//           linear has an inverse within [0, divisor].
// Keeps     f(0) = 0; linear f(divisor) = 1; logarithmic and exponentiation f(maximum) = 1;
//           log_tonemap f(limit) = 1.
// Differs   luminance variants are 0/0 at black in every source; here black stays black. ln(1 + x)
//           keeps its digits for small x. exponentiation is black up to 2^-100, because its slope
//           at 0 is infinite. log_tonemap's S-curve ("hacky contrast") falls above 1 and is
//           negative from 1.5, so its input is limited to [0, 1]; the post has a dash instead of
//           the minus sign and no closing braces.
// Check     mid gray 0.18 -> 0.045 (linear), 0.164729789 (exponential), 0.0358635138 (logarithmic),
//           0.0584193346 (log_tonemap), 0.0424264069 (exponentiation)
//           (python_check/operators/exposure.py).
#include <cmath>

#include "operators/family.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr const char* kZeltner =
    "T. Zeltner, Tone Mapper, github.com/tizian/tonemapper, commit dd9f7c8, 2015";
constexpr const char* kChannelsMayClip =
    "apply=luminance keeps chromaticity, so a saturated channel may exceed 1 and clip";

/// A parameter that the maximum of the picture sets.
ParameterSpec maximum_luminance(std::string name, double value, double min, std::string help) {
    return statistic_parameter(
        number_parameter(std::move(name), "scene-linear", value, min, kHalfMax, std::move(help)),
        "maximum luminance", [](const SceneStatistics& s) { return s.maximum_luminance; });
}

Operator linear() {
    Operator op;
    op.id = "linear";
    op.title = "Linear (division by the maximum)";
    op.view = "Linear";
    op.character =
        "contrast and colors of the scene, then a clip; dark if the picture has bright highlights";
    op.source = "common practice; division by the maximum in 64, Tone Mapping, 64.github.io";
    op.license = "common practice";
    op.negatives = kNegativesClampAtZero;
    op.parameters = with_apply(
        "channels", {maximum_luminance("divisor", 4, 1e-6, "scene value shown as display white")});
    op.build = [](const Params& p) -> Pipeline {
        const Expr x = Expr::input();
        const Expr divisor = p.expr("divisor");
        return tone_curve_pipeline({.f = x / divisor, .inverse = x * divisor}, p) +
               Pipeline{ClampStage{0, 1}};
    };
    return op;
}

Operator exponential() {
    Operator op;
    op.id = "exponential";
    op.title = "Exponential";
    op.view = "Exponential";
    op.character =
        "steep in the shadows, soft above the average, never clips a gray; bright, with flat "
        "highlights";
    op.source = std::string("1 - exp(-L/Lavg) as in ") + kZeltner;
    op.license = "published formula (program: MIT)";
    op.negatives = kNegativesClampAtZero;
    op.parameters = with_apply(
        "luminance",
        {statistic_parameter(number_parameter("average", "scene-linear", 1, 1e-6, kHalfMax,
                                              "scene value shown at display-linear 1 - 1/e = 0.63"),
                             "mean luminance",
                             [](const SceneStatistics& s) { return s.mean_luminance; })});
    // 1/(1.590579 ln 2) and 1/ln 2: Babylon.js raises 2 instead of e.
    op.presets = {
        {"channels",
         "1 - exp(-x) of each channel: VTK, CEToneMapping of Orillusion",
         {{"apply", "channels"}, {"average", "1"}}},
        {"babylon",
         "Standard tone mapping of Babylon.js, 1 - 2^(-1.590579 x)",
         {{"apply", "channels"}, {"average", "0.9070250776"}}},
        {"babylon_photographic",
         "Photographic tone mapping of Babylon.js, 1 - 2^(-x)",
         {{"apply", "channels"}, {"average", "1.442695041"}}},
    };
    op.warnings = {kChannelsMayClip};
    op.build = [](const Params& p) -> Pipeline {
        return tone_curve_pipeline({.f = 1 - exp(-(Expr::input() / p.expr("average")))}, p);
    };
    return op;
}

Operator logarithmic() {
    Operator op;
    op.id = "logarithmic";
    op.title = "Logarithmic";
    op.view = "Logarithmic";
    op.character =
        "equal steps for equal ratios: opens shadows, low contrast everywhere, dark midtones";
    op.source = std::string("log10(1 + p L)/log10(1 + p Lmax) as in ") + kZeltner;
    op.license = "published formula (program: MIT)";
    op.negatives = kNegativesClampAtZero;
    op.parameters = with_apply(
        "luminance",
        {number_parameter("p", "", 1, 0.001, 1000,
                          "factor on the scene value in the logarithm; larger is flatter"),
         maximum_luminance("maximum", 100, 1e-6, "scene value shown as display white")});
    op.warnings = {kChannelsMayClip};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, 2.4, ""}};
    op.build = [](const Params& p) -> Pipeline {
        const Expr scale = p.expr("p");
        const Expr at_maximum = named("at_maximum", log_of_1_plus(scale * p.expr("maximum")));
        return tone_curve_pipeline({.f = log_of_1_plus(scale * Expr::input()) / at_maximum}, p);
    };
    return op;
}

Operator log_tonemap() {
    Operator op;
    op.id = "log_tonemap";
    op.title = "Log tone map (Madams)";
    op.view = "Log Tone Map";
    op.character =
        "a logarithm that reaches white at `limit`; flat, unless the optional S-curve follows it";
    op.source =
        "T. Madams, Why Reinhard desaturates my blacks, imdoingitwrong.wordpress.com, 2010-08-19, "
        "comment 9";
    op.license = "published formula";
    op.negatives = kNegativesClampAtZero;
    op.parameters = with_apply(
        "luminance", {maximum_luminance("limit", 16, 0.001, "scene value shown as display white"),
                      number_parameter("contrast", "", 0, 0, 1,
                                       "share of the S-curve x^2 (3 - 2x), per channel, after a "
                                       "limit to [0, 1] (0: no curve and no limit)")});
    op.warnings = {kChannelsMayClip};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, 3.9, ""}};
    op.build = [](const Params& p) -> Pipeline {
        const Expr x = Expr::input();
        const Expr contrast = p.expr("contrast");
        Pipeline tone =
            tone_curve_pipeline({.f = log_of_1_plus(x) / log_of_1_plus(p.expr("limit"))}, p);
        if (contrast.is_constant(0)) return tone;
        const auto curved = [&](const Expr& v) { return mix(v, v * v * (3 - 2 * v), contrast); };
        if (contrast.is_constant())
            return tone + Pipeline{ClampStage{0, 1}, curve_stage(curved(x))};
        const Expr limited = named("limited", clamp(x, 0, 1));
        return tone + Pipeline{curve_stage(select(equal(contrast, 0), x, curved(limited)))};
    };
    return op;
}

Operator exponentiation() {
    Operator op;
    op.id = "exponentiation";
    op.title = "Exponentiation";
    op.view = "Exponentiation";
    op.character =
        "a power of the scene: reduces every contrast by the same factor; lifts shadows, flat";
    op.source = std::string("(L/Lmax)^p as in ") + kZeltner;
    op.license = "published formula (program: MIT)";
    op.negatives = kNegativesClampAtZero;
    op.parameters = with_apply(
        "luminance",
        {number_parameter("p", "", 0.5, 0.01, 1, "exponent; smaller is flatter, 1 is linear"),
         maximum_luminance("maximum", 100, 1e-6, "scene value shown as display white")});
    op.warnings = {kChannelsMayClip};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, kInfinity, ""}};
    op.bounds.ocio_cpu = op.bounds.ocio_gpu = 2e-3;
    op.bounds.reason = "infinite slope at black, and half floats end at 6e-8";
    op.build = [](const Params& p) -> Pipeline {
        const Expr x = Expr::input();
        const Expr power = named("power", pow(x / p.expr("maximum"), p.expr("p")));
        return tone_curve_pipeline({.f = select(less(0x1p-100, x), power, 0)}, p);
    };
    return op;
}

}  // namespace

std::vector<Operator> define_exposure() {
    return {linear(), exponential(), logarithmic(), log_tonemap(), exponentiation()};
}

TONEWRIGHT_NAMESPACE_END
