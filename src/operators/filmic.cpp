// SPDX-License-Identifier: Apache-2.0
//
// Filmic curves: toe, linear segment and shoulder, with few parameters each.
//
// Source    hejl_burgess_dawson: J. Hejl, R. Burgess-Dawson, in J. Hable, "Filmic Tonemapping
//           Operators", filmicworlds.com, 2010-05-05. hejl_2015: J. Hejl,
//           twitter.com/jimhejl/status/633777619998130176, 2015, as in M. Pettineo's BakingLab,
//           ToneMapping.hlsl. aldridge: G. Aldridge, "Approximating Film with Tonemapping",
//           iwasbeingirony.blogspot.com, 2010-04-19, as in T. Zeltner, "Tone Mapper"
//           (github.com/tizian/tonemapper). lottes: T. Lottes, "Advanced Techniques and
//           Optimization of HDR Color Pipelines", GDC 2016; presets: VTK 9.6.2, vtkToneMappingPass.
//           hejl_burgess_dawson:babylon: Babylon.js, @babylonjs/core 9.35.0, TonemapPostProcess.
//           filament_generic: Filament,
//           ToneMapper.cpp, GenericToneMapper. ue3: Unreal Engine 3 documentation, "Color Grading",
//           by way of R. Guy's shadertoy llXyWr. day: M. Day, "An efficient and user-friendly tone
//           mapping operator", Insomniac Games, 2012. schlick: C. Schlick, "Quantization Techniques
//           for Visualization of High Dynamic Range Pictures", Eurographics Workshop on Rendering,
//           1994. toe: ours, after descriptions in T. Madams, "Why Reinhard desaturates my blacks",
//           imdoingitwrong.wordpress.com, 2010-08-19.
// In        scene-linear RGB, working primaries Rec.709, D65; domain [0, 65504], negatives: clamped
//           at 0.
// Out       CODE VALUES of a 2.2 power: hejl_burgess_dawson (without output=squared) and aldridge
//           [0, 1), ue3 [0, 1]. The others: display-linear RGB, 1.0 = display peak, and all may
//           exceed it: hejl_2015
//           [-0.00072, 1.038), filament_generic up to its output scale, schlick up to p/(p-1), day
//           up to the end of its shoulder, lottes and toe without an upper bound.
// Kind      per channel; schlick luminance. Monotone on the neutral axis: yes, except that lottes
//           falls again with a shoulder above 1.
// Keeps     hejl_2015, day f(white) = 1; lottes, filament_generic f(mid_in) = mid_out and
//           f(hdr_max) = 1; schlick f(maximum) = 1; toe: values above its width.
// Differs   hejl_burgess_dawson, schlick: nowhere (T. Zeltner's schlick ignores p). ue3: most ports
//           reach code values of 1.019; here they end at 1, like the display.
//           hejl_2015: the first factor is BakingLab's 1.435; others quote the author's post with
//           1.425, which is up to 0.0017 darker.
//           aldridge: below twice the cutoff, v + (2q - v)^2/(4q) - q is written as v^2/(4q). It is
//           equal without the difference, so 0 stays 0. With a cutoff above 0.5 the source is
//           negative for low values, down to the pole of the rational; here it is 0.
//           lottes: the power in the denominator ends at 2^-100, because the slope of a power below
//           1 is infinite at 0. Like all ports, it leaves out the talk's crosstalk between the
//           channels.
//           filament_generic: Filament applies it in Rec.2020.
//           day: both denominators are written so that they keep their digits if the crossover is
//           close to black or white.
// Check     mid gray 0.18 -> 0.508028282 (hejl_burgess_dawson), 0.237508884 (hejl_2015),
//           0.479315490 (aldridge), 0.267 (lottes), 0.215 (filament_generic), 0.547522388 (ue3),
//           0.00341873507 (day), 0.0348095146 (schlick), 0.18 (toe)
//           (python_check/operators/filmic.py).
#include <cmath>

#include "base/format_number.h"
#include "operators/family.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Its output is code values: the constants include a 2.2 power.
constexpr double kBakedPower = 2.2;

/// Rational that approximates Kodak's film, print and gamma, for x >= 0.
Expr hejl_rational(const Expr& x) { return x * (6.2 * x + 0.5) / (x * (6.2 * x + 1.7) + 0.06); }

Operator hejl_burgess_dawson() {
    Operator op;
    op.id = "hejl_burgess_dawson";
    op.title = "Hejl/Burgess-Dawson";
    op.view = "Hejl Burgess-Dawson";
    op.character =
        "film print in four constants: crisp blacks, high contrast, long shoulder; crushes the "
        "deepest shadows";
    op.source =
        "J. Hejl, R. Burgess-Dawson, in J. Hable, Filmic Tonemapping Operators, filmicworlds.com, "
        "2010-05-05";
    op.license = "published formula";
    op.negatives = kNegativesClampAtZero;
    op.output = OutputKind::code_value;
    op.code_power = kBakedPower;
    op.dialects = "Hejl";
    op.parameters = with_apply(
        "channels", {choice_parameter("output", {"code_values", "squared"}, "code_values",
                                      "code_values: code values of a 2.2 power; squared: "
                                      "display-linear, the square of the code values")});
    op.presets = {{"babylon",
                   "Hejl-Dawson tone mapping of Babylon.js, which squares the code values",
                   {{"output", "squared"}}}};
    op.differences = {{DocumentedDifference::Kind::crushes_black, 0.004, ""}};
    op.display = [](const Params& p) -> std::string {
        return p.choice("output") == "squared" ? "linear" : "";
    };
    op.build = [](const Params& p) -> Pipeline {
        const Expr f = hejl_rational(max(Expr::input() - 0.004, 0));
        if (p.choice("output") == "squared") return tone_curve_pipeline({.f = f * f}, p);
        return tone_curve_pipeline({.f = f, .code_power = kBakedPower}, p);
    };
    return op;
}

Operator hejl_2015() {
    Operator op;
    op.id = "hejl_2015";
    op.title = "Hejl 2015";
    op.view = "Hejl 2015";
    op.character =
        "Hejl's film curve with display-linear output and an adjustable white: softer toe, very "
        "long shoulder";
    op.source =
        "J. Hejl, twitter.com/jimhejl/status/633777619998130176, 2015, as in M. Pettineo's "
        "BakingLab, ToneMapping.hlsl";
    op.license = "published formula (BakingLab: MIT)";
    op.negatives = kNegativesClampAtZero;
    op.dialects = "Hejl";
    op.parameters =
        with_apply("channels", {number_parameter("white", "scene-linear", 11.2, 0.1, kHalfMax,
                                                 "lowest scene value shown as display white")});
    op.warnings = {"other sources quote 1.425 where BakingLab and this operator use 1.435"};
    op.differences = {{DocumentedDifference::Kind::black, -0.00072, ""},
                      {DocumentedDifference::Kind::crushes_black, 0.0046, ""},
                      {DocumentedDifference::Kind::exceeds_white, 1.0, ""}};
    op.build = [](const Params& p) -> Pipeline {
        const auto f = [](const Expr& v) {
            const Expr a = named("a", 1.435 * v + 0.05);
            return (v * a + 0.004) / (v * (a + 0.55) + 0.0491) - 0.0821;
        };
        return tone_curve_pipeline({.f = f(Expr::input()) / f(p.expr("white"))}, p);
    };
    return op;
}

Operator aldridge() {
    Operator op;
    op.id = "aldridge";
    op.title = "Aldridge";
    op.view = "Aldridge";
    op.character = "Hejl/Burgess-Dawson with a soft toe instead of crushed blacks";
    op.source =
        "G. Aldridge, Approximating Film with Tonemapping, iwasbeingirony.blogspot.com, "
        "2010-04-19, as in T. Zeltner, Tone Mapper, github.com/tizian/tonemapper";
    op.license = "published formula (program: MIT)";
    op.negatives = kNegativesClampAtZero;
    op.output = OutputKind::code_value;
    op.code_power = kBakedPower;
    op.dialects = "Hejl";
    op.parameters = with_apply(
        "channels",
        {number_parameter(
            "cutoff", "scene-linear", 0.025, 0.001, 1,
            "value subtracted from the highlights; the toe reaches up to twice this value")});
    op.build = [](const Params& p) -> Pipeline {
        const Expr q = p.expr("cutoff");
        const Expr v = Expr::input();
        // v + (2q - v) clamp(2q - v, 0, 1) (0.25/q) - q
        Expr x = select(less(v, 2 * q), v * v / (4 * q), v - q);
        // No value below 2q - 1 reaches the curve, where the clamp is 0.
        if (!fails(less(0.5, q)))
            x = select(less(v, 2 * q - 1), max(v + (2 * q - v) * (0.25 / q) - q, 0), x);
        return tone_curve_pipeline({.f = hejl_rational(x), .code_power = kBakedPower}, p);
    };
    return op;
}

/// x^a/(b x^(a d) + c) through (mid_in, mid_out) and (hdr_max, 1).
Expr lottes_curve(const Params& p) {
    const Expr a = p.expr("contrast");
    const Expr d = p.expr("shoulder");
    const Expr hdr_max = p.expr("hdr_max");
    const Expr mid_in = p.expr("mid_in");
    const Expr mid_out = p.expr("mid_out");
    if (fails(less(mid_in, hdr_max))) {
        throw Error("hdr_max is " + shortest(hdr_max.value()) + "; expected above mid_in, " +
                    shortest(mid_in.value()));
    }
    const Expr max_a = named("max_a", pow(hdr_max, a));
    const Expr max_ad = named("max_ad", pow(hdr_max, a * d));
    const Expr mid_a = named("mid_a", pow(mid_in, a));
    const Expr mid_ad = named("mid_ad", pow(mid_in, a * d));
    const Expr b = named("b", (max_a * mid_out - mid_a) / ((max_ad - mid_ad) * mid_out));
    const Expr c =
        named("c", (max_ad * mid_a - max_a * mid_ad * mid_out) / ((max_ad - mid_ad) * mid_out));
    if (fails(less(0, b))) {
        throw Error("mid_out is " + shortest(mid_out.value()) + "; expected above " +
                    shortest((mid_a / max_a).value()) + ", where the curve has no shoulder");
    }
    if (fails(less(0, c))) {
        throw Error("mid_out is " + shortest(mid_out.value()) + "; expected below " +
                    shortest((max_ad * mid_a / (max_a * mid_ad)).value()) +
                    ", where the curve has no toe (a larger shoulder allows more)");
    }
    const Expr x = Expr::input();
    return pow(x, a) / (b * pow(max(x, 0x1p-100), a * d) + c);
}

Operator lottes() {
    Operator op;
    op.id = "lottes";
    op.title = "Lottes";
    op.view = "Lottes";
    op.character =
        "separate contrast and shoulder, fixed mid gray and white: bright midtones, deep blacks";
    op.source = "T. Lottes, Advanced Techniques and Optimization of HDR Color Pipelines, GDC 2016";
    op.license = "published formula";
    op.negatives = kNegativesClampAtZero;
    op.dialects = "Lottes";
    op.parameters = with_apply(
        "channels",
        {number_parameter("contrast", "", 1.6, 1, 2, "a: power of the toe"),
         number_parameter("shoulder", "", 0.977, 0.01, 2,
                          "d: smaller is softer; with 1 the curve has an upper bound"),
         number_parameter("hdr_max", "scene-linear", 8, 1, kHalfMax,
                          "scene value shown as display white"),
         number_parameter("mid_in", "scene-linear", 0.18, 0.01, 1, "mid gray of the scene"),
         number_parameter("mid_out", "display-linear", 0.267, 0.01, 0.99,
                          "display-linear value of mid gray")});
    op.presets = {{"vtk",
                   "default of vtkToneMappingPass, GenericFilmic without ACES",
                   {{"contrast", "1.6773"},
                    {"shoulder", "0.9714"},
                    {"hdr_max", "11.0785"},
                    {"mid_out", "0.18"}}},
                  {"vtk_uncharted2",
                   "Uncharted 2 preset of vtkToneMappingPass",
                   {{"contrast", "1.1759"},
                    {"shoulder", "0.9746"},
                    {"hdr_max", "6.3704"},
                    {"mid_out", "0.18"}}}};
    op.warnings = {"with a shoulder above 1, highlights above some scene value get darker again"};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, 1.4, ""},
                      {DocumentedDifference::Kind::exceeds_white, 1.52, "vtk"},
                      {DocumentedDifference::Kind::exceeds_white, 1.41, "vtk_uncharted2"}};
    op.bounds = {.simd = 1e-5,
                 .reason =
                     "with a shoulder above 1 the curve may rise far above white and fall again, "
                     "and apply=hue_preserving subtracts such values"};
    op.build = [](const Params& p) -> Pipeline {
        return tone_curve_pipeline({.f = lottes_curve(p)}, p);
    };
    return op;
}

/// The same with d = 1, with Filament's names.
Expr filament_curve(const Params& p) {
    const Expr contrast = p.expr("contrast");
    const Expr mid_out = p.expr("mid_out");
    const Expr a = named("a", pow(p.expr("mid_in"), contrast));
    const Expr b = named("b", pow(p.expr("hdr_max"), contrast));
    if (fails(less(a, b))) {
        throw Error("hdr_max is " + shortest(p.number("hdr_max")) + "; expected above mid_in, " +
                    shortest(p.number("mid_in")));
    }
    const Expr c = named("c", a - mid_out * b);
    if (fails(less(c, 0) * less(mid_out, 1))) {
        throw Error("mid_out is " + shortest(mid_out.value()) + "; expected between " +
                    shortest((a / b).value()) +
                    ", where the curve has no shoulder, and 1, where it has no toe");
    }
    const Expr input_scale = named("input_scale", a * b * (mid_out - 1) / c);
    const Expr output_scale = named("output_scale", mid_out * (a - b) / c);
    const Expr power = named("power", pow(Expr::input(), contrast));
    return output_scale * power / (power + input_scale);
}

Operator filament_generic() {
    Operator op;
    op.id = "filament_generic";
    op.title = "Generic (Filament)";
    op.view = "Filament Generic";
    op.character = "Lottes without the shoulder parameter: its upper bound is a little above white";
    op.source =
        "Filament, filament/src/ToneMapper.cpp, GenericToneMapper, github.com/google/filament";
    op.license = "Apache-2.0";
    op.negatives = kNegativesClampAtZero;
    op.dialects = "Lottes";
    op.parameters = with_apply(
        "channels",
        {number_parameter("contrast", "", 1.55, 1, 3, "power of the toe"),
         number_parameter("mid_in", "scene-linear", 0.18, 0.01, 1, "mid gray of the scene"),
         number_parameter("mid_out", "display-linear", 0.215, 0.01, 1,
                          "display-linear value of mid gray"),
         number_parameter("hdr_max", "scene-linear", 10, 1, kHalfMax,
                          "scene value shown as display white")});
    op.differences = {{DocumentedDifference::Kind::exceeds_white, 1.0, ""}};
    op.build = [](const Params& p) -> Pipeline {
        return tone_curve_pipeline({.f = filament_curve(p)}, p);
    };
    return op;
}

Operator ue3() {
    Operator op;
    op.id = "ue3";
    op.title = "Unreal Engine 3";
    op.view = "Unreal 3";
    op.character = "Reinhard's shape in code values: bright, low contrast, no toe; white at 8.2";
    op.source = "Unreal Engine 3 documentation, Color Grading; R. Guy, shadertoy llXyWr";
    op.license = "published formula";
    op.negatives = kNegativesClampAtZero;
    op.output = OutputKind::code_value;
    op.code_power = kBakedPower;
    op.dialects = "Unreal";
    op.parameters = with_apply("channels");
    op.build = [](const Params& p) -> Pipeline {
        const Expr x = Expr::input();
        return tone_curve_pipeline({.f = x / (x + 0.155) * 1.019, .code_power = kBakedPower}, p) +
               Pipeline{ClampStage{0, 1}};
    };
    return op;
}

/// Two hyperbolas that meet at (c, k) with equal slope: a toe from black b and a shoulder to white
/// w.
Expr day_curve(const Params& p) {
    const Expr w = p.expr("white");
    const Expr b = p.expr("black");
    const Expr t = p.expr("toe");
    const Expr s = p.expr("shoulder");
    const Expr c = p.expr("crossover");
    if (fails(less(b, c) * less(c, w))) {
        throw Error("crossover is " + shortest(c.value()) + "; expected between black, " +
                    shortest(b.value()) + ", and white, " + shortest(w.value()));
    }
    const Expr k = named("k", (1 - t) * (c - b) / ((1 - s) * (w - c) + (1 - t) * (c - b)));
    const Expr x = Expr::input() / p.expr("average");
    const Expr below = named("below", min(x, c));
    const Expr above = named("above", max(x, c));
    // c - (1-t) b - t x and s x + (1-s) w - c of the paper
    const Expr toe =
        named("toe", k * (1 - t) * (below - b) / (t * (c - below) + (1 - t) * (c - b)));
    const Expr shoulder =
        named("shoulder", (1 - k) * (above - c) / (s * (above - c) + (1 - s) * (w - c)) + k);
    return select(less(x, c), toe, shoulder);
}

Operator day() {
    Operator op;
    op.id = "day";
    op.title = "Day (Insomniac)";
    op.view = "Day";
    op.character =
        "manual black, white, crossover and two strengths; dark with hard blacks by default";
    op.source =
        "M. Day, An efficient and user-friendly tone mapping operator, Insomniac Games, 2012";
    op.license = "published formula";
    op.bounds = {.ocio_gpu = 3e-6, .reason = "steep slope just above black"};
    op.negatives = kNegativesClampAtZero;
    op.parameters = with_apply(
        "channels",
        {number_parameter("white", "times the average", 10, 0.1, kHalfMax,
                          "value shown as display white"),
         number_parameter("black", "times the average", 0.1, 0, 1,
                          "value shown as black; the curve is negative below it"),
         number_parameter("toe", "", 0.7, 0, 0.99, "strength of the toe (0: straight line)"),
         number_parameter("shoulder", "", 0.8, 0, 0.99,
                          "strength of the shoulder (0: straight line)"),
         number_parameter("crossover", "times the average", 2, 0.01, 1000,
                          "value where the toe meets the shoulder"),
         statistic_parameter(
             number_parameter("average", "scene-linear", 1, 1e-6, kHalfMax,
                              "scene value that is the unit of white, black and crossover"),
             "mean luminance", [](const SceneStatistics& s) { return s.mean_luminance; })});
    op.differences = {{DocumentedDifference::Kind::black, -0.0040, ""},
                      {DocumentedDifference::Kind::crushes_black, 0.099, ""},
                      {DocumentedDifference::Kind::exceeds_white, 1.2, ""}};
    op.build = [](const Params& p) -> Pipeline {
        return tone_curve_pipeline({.f = day_curve(p)}, p);
    };
    return op;
}

Operator schlick() {
    Operator op;
    op.id = "schlick";
    op.title = "Schlick";
    op.view = "Schlick";
    op.character =
        "Reinhard's shape with white fixed at the maximum: opens shadows, soft highlights";
    op.source =
        "C. Schlick, Quantization Techniques for Visualization of High Dynamic Range Pictures, "
        "Eurographics Workshop on Rendering, 1994";
    op.license = "published formula";
    op.negatives = kNegativesClampAtZero;
    op.parameters = with_apply(
        "luminance",
        {number_parameter("p", "", 20, 1, 1000, "slope at black times the maximum (1: linear)"),
         statistic_parameter(number_parameter("maximum", "scene-linear", 100, 1e-6, kHalfMax,
                                              "scene value shown as display white"),
                             "maximum luminance",
                             [](const SceneStatistics& s) { return s.maximum_luminance; })});
    op.warnings = {
        "apply=luminance keeps chromaticity, so a saturated channel may exceed 1 and clip"};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, 1.1, ""}};
    op.build = [](const Params& params) -> Pipeline {
        const Expr x = Expr::input();
        const Expr p = params.expr("p");
        const Expr f = p * x / (p * x - x + params.expr("maximum"));
        return tone_curve_pipeline({.f = f}, params);
    };
    return op;
}

Operator toe() {
    Operator op;
    op.id = "toe";
    op.title = "Toe";
    op.view = "Toe";
    op.character =
        "darkens only the deepest shadows, as in games of 2009: on the unchanged scene, or (ramp) "
        "on Reinhard Extended";
    op.source =
        "Tonewright, after T. Madams, Why Reinhard desaturates my blacks, "
        "imdoingitwrong.wordpress.com, 2010-08-19, which describes the toes of two games without a "
        "formula";
    op.license = "Apache-2.0";
    op.negatives = kNegativesClampAtZero;
    op.parameters = with_apply(
        "channels",
        {choice_parameter("form", {"quadratic", "ramp"}, "quadratic",
                          "quadratic: a smooth toe on the scene value; ramp: two "
                          "multiply-adds after Reinhard Extended"),
         number_parameter("width", "", 0.05, 0.001, 1, "value at the end of the toe"),
         number_parameter("strength", "", 1, 0, 1,
                          "strength of the toe (0: no toe, 1: zero slope at black)"),
         number_parameter("brightness", "", 0, -1, 1, "offset added after the toe"),
         number_parameter("contrast", "", 1, 0.01, 4, "contrast about 0.5, after the toe"),
         number_parameter("white", "scene-linear", 4, 0.01, kHalfMax,
                          "white of Reinhard Extended; only with form=ramp")});
    op.presets = {{"ramp",
                   "Reinhard Extended with darker shadows",
                   {{"form", "ramp"}, {"width", "0.25"}, {"strength", "0.5"}}}};
    op.warnings = {"Tonewright defines this formula, because neither game published its own"};
    op.bounds.ocio_cpu = op.bounds.ocio_gpu = 5e-5;
    op.bounds.reason = "the slope jumps at the end of the ramp, between two half floats";
    op.differences = {{DocumentedDifference::Kind::exceeds_white, kInfinity, ""}};
    op.build = [](const Params& p) -> Pipeline {
        const Expr x = Expr::input();
        const Expr width = p.expr("width");
        const Expr strength = p.expr("strength");
        const Expr contrast = p.expr("contrast");
        Expr y = x;
        if (p.choice("form") == "quadratic") {
            const Expr u = named("u", min(x, width));
            const Expr toe =
                (1 - strength) * u + strength * (u * u * (2 * width - u) / (width * width));
            y = select(less(x, width), toe, x);
        } else {
            const Expr white = p.expr("white");
            const Expr r = named("r", x * (1 + x / (white * white)) / (1 + x));
            const Expr weight = named("weight", clamp(1 - r / width, 0, 1));
            y = r - strength * weight * r;
        }
        // (y - 0.5) contrast + 0.5 + brightness
        return tone_curve_pipeline(
            {.f = contrast * y + (p.expr("brightness") + 0.5 - 0.5 * contrast)}, p);
    };
    return op;
}

}  // namespace

std::vector<Operator> define_filmic() {
    return {hejl_burgess_dawson(),
            hejl_2015(),
            aldridge(),
            lottes(),
            filament_generic(),
            ue3(),
            day(),
            schlick(),
            toe()};
}

TONEWRIGHT_NAMESPACE_END
