// SPDX-License-Identifier: Apache-2.0
//
// Reinhard's global operator and its variants: with a white point, with a key and an average,
// blended, with constant luminance; and the photoreceptor model of Reinhard and Devlin.
//
// Source    E. Reinhard, M. Stark, P. Shirley, J. Ferwerda, "Photographic Tone Reproduction for
//           Digital Images", ACM Transactions on Graphics 21(3), SIGGRAPH 2002: equation 3
//           (reinhard), equation 4 (reinhard_extended), equations 2 and 4 (nebula, with the
//           constants of the Nebula engine's post on HDR). "Reinhard-Jodie": Jodie, shadertoy
//           4dBcD1, 2017. reinhard2: postprocessing 6.39.6, three-stdlib 2.36.1. Weights and
//           presets of engines: @babylonjs/core 9.35.0 (TonemapPostProcess), lygia 1.4.1,
//           @cesium/engine 26.3.0. reinhard_constant_luminance: 64, code/tonemapping
//           of 64.github.io. E. Reinhard, K. Devlin, "Dynamic Range Reduction Inspired by
//           Photoreceptor Physiology", IEEE Transactions on Visualization and Computer Graphics
//           11(1), 2005. opencv_reinhard: OpenCV 4.6.0, photo, TonemapReinhard, executed.
// In        scene-linear RGB, working primaries Rec.709, D65; domain [0, 65504], negatives clamped
//           at 0 (f has a pole at -1).
// Out       display-linear RGB, 1.0 = display peak; reinhard and reinhard_devlin [0, 1),
//           reinhard_extended and nebula unbounded above their white. Pure blue reaches 1.36 with
//           reinhard_jodie and 13.9 with reinhard_constant_luminance.
// Kind      per channel, luminance or max (parameter `apply`); jodie and constant_luminance 3D,
//           devlin a curve and 3D. Monotone on the neutral axis: yes; analytic inverse of reinhard:
//           yes.
// Keeps     f(0) = 0; reinhard f'(0) = 1; reinhard_extended f(white) = 1; nebula
//           f(average maximum/middle_grey) = 1.
// Differs   the paper first scales by key/log-average; here that is the exposure (nebula has both
//           as parameters). Luminance variants are 0/0 at black in every source; here black stays
//           black, the limit.
//           nebula: the post's code does not divide by the luminance, so its picture is quadratic
//           near black and has no upper bound; copies of the code do the same. The post limits the
//           average to [0.3, 1]. Neither applies here. reinhard2 is such a copy.
//           reinhard:babylon: 0/0 is NaN at black in the engine, and its weights sum to 0.998.
//           opencv_reinhard: OpenCV measures minimum and maximum twice, before and after the curve.
//           The second pair is a parameter, because no statistic of the scene gives it. The key
//           comes from relative luminance; OpenCV takes it from 0.114 R + 0.587 G + 0.299 B, at
//           least 1e-4 of the maximum. Calling `process` twice on one object of OpenCV changes its
//           intensity; here nothing does. OpenCV's gamma is the encoding of the display.
//           reinhard_devlin: the adaptation is at least 2^-100; the paper has 0/0 where it is 0.
//           The 3D part is a function of a power of the channels, so that 3D LUTs fit it better;
//           the values are the same.
// Check     mid gray 0.18 -> 0.152542373 (reinhard), 0.154258475 (reinhard_extended), 0.177781456
//           (nebula), 0.334941443 (reinhard_devlin) (python_check/operators/reinhard.py).
#include <algorithm>
#include <cmath>

#include "base/format_number.h"
#include "operators/family.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Channels = std::array<Expr, 3>;

Channels inputs() { return {Expr::input(0), Expr::input(1), Expr::input(2)}; }

Expr luminance_of(const Channels& c, const Vector3& w = kRec709Weights) {
    return w[0] * c[0] + w[1] * c[1] + w[2] * c[2];
}

/// Parameter of the luminance's weights. Engines round or replace those of Rec.709.
ParameterSpec weights_parameter(std::vector<std::string> choices) {
    return choice_parameter("weights", std::move(choices), "rec709",
                            "weights of the luminance: Rec.709, or those of an engine");
}

Vector3 weights_of(const Params& p) {
    const std::string& weights = p.choice("weights");
    if (weights == "babylon") return {0.22, 0.707, 0.071};
    return weights == "lygia" ? kLygiaWeights : kRec709Weights;
}

Operator simple() {
    Operator op;
    op.id = "reinhard";
    op.title = "Reinhard";
    op.view = "Reinhard";
    op.character = "soft everywhere, never reaches white; flat and gray in bright scenes";
    op.source =
        "Reinhard, Stark, Shirley, Ferwerda, Photographic Tone Reproduction for Digital Images, "
        "SIGGRAPH 2002, eq. 3";
    op.license = "published formula";
    op.negatives = kNegativesClampAtZero;
    op.dialects = "Reinhard";
    op.parameters = with_apply("channels", {weights_parameter({"rec709", "babylon", "lygia"})});
    op.presets = {{"luminance", "Reinhard on luminance", {{"apply", "luminance"}}},
                  {"max", "Reinhard on the largest channel", {{"apply", "max"}}},
                  {"babylon",
                   "Reinhard of Babylon.js' TonemapPostProcess, on its own luminance",
                   {{"apply", "luminance"}, {"weights", "babylon"}}},
                  {"lygia",
                   "tonemapReinhard of lygia, on its own luminance",
                   {{"apply", "luminance"}, {"weights", "lygia"}}}};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, 1.002, "babylon"}};
    op.warnings = {
        "apply=luminance keeps chromaticity, so a saturated channel may exceed 1 and clip"};
    op.build = [](const Params& p) -> Pipeline {
        const Expr x = Expr::input();
        const Expr f = x / (1 + x);
        const Expr inverse = named("inverse", x / (1 - x));
        return tone_curve_pipeline({.f = f, .inverse = inverse, .weights = weights_of(p)}, p);
    };
    return op;
}

Operator extended() {
    Operator op;
    op.id = "reinhard_extended";
    op.title = "Reinhard Extended";
    op.view = "Reinhard Extended";
    op.character = "Reinhard with an adjustable white";
    op.source =
        "Reinhard, Stark, Shirley, Ferwerda, Photographic Tone Reproduction for Digital Images, "
        "SIGGRAPH 2002, eq. 4";
    op.license = "published formula";
    op.negatives = kNegativesClampAtZero;
    op.dialects = "Reinhard";
    op.parameters =
        with_apply("channels", {number_parameter("white", "scene-linear", 4, 0.01, kHalfMax,
                                                 "lowest scene value shown as display white")});
    op.presets = {{"luminance", "Reinhard Extended on luminance", {{"apply", "luminance"}}},
                  {"max", "Reinhard Extended on the largest channel", {{"apply", "max"}}},
                  {"cesium",
                   "Cesium's Modified Reinhard with its default white, which changes nothing",
                   {{"white", "1"}}}};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, kInfinity, ""}};
    op.build = [](const Params& p) -> Pipeline {
        const Expr x = Expr::input();
        const Expr white = p.expr("white");
        const Expr f = x * (1 + x / (white * white)) / (1 + x);
        return tone_curve_pipeline({.f = f}, p);
    };
    return op;
}

Operator nebula() {
    Operator op;
    op.id = "nebula";
    op.title = "Reinhard with key (Nebula)";
    op.view = "Nebula";
    op.character =
        "Reinhard Extended after an automatic exposure, which shows the mean of the picture at "
        "middle_grey/(1 + middle_grey)";
    op.source =
        "Nebula engine, post on HDR, after Reinhard, Stark, Shirley, Ferwerda, Photographic Tone "
        "Reproduction for Digital Images, SIGGRAPH 2002, eq. 2 and 4";
    op.license = "published formula";
    op.negatives = kNegativesClampAtZero;
    op.dialects = "Reinhard";
    op.parameters = with_apply(
        "luminance",
        {number_parameter("middle_grey", "", 0.6, 0.01, 1, "key: scaled value of the average"),
         number_parameter("maximum", "scene-linear, after the key", 16, 0.01, kHalfMax,
                          "lowest scaled value shown as display white"),
         statistic_parameter(number_parameter("average", "scene-linear", 0.5, 0.001, kHalfMax,
                                              "mean luminance of the scene"),
                             "mean luminance",
                             [](const SceneStatistics& s) { return s.mean_luminance; })});
    op.warnings = {
        "programs that use the printed code show another picture, quadratic near black, because "
        "they do not divide by the luminance"};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, kInfinity, ""}};
    op.build = [](const Params& p) -> Pipeline {
        const Expr white = p.expr("maximum");
        const Expr scaled =
            named("scaled", Expr::input() * (p.expr("middle_grey") / p.expr("average")));
        const Expr f = scaled * (1 + scaled / (white * white)) / (1 + scaled);
        return tone_curve_pipeline({.f = f}, p);
    };
    return op;
}

/// Equation 4 times the color, without the division by its luminance.
Operator nebula_as_printed() {
    Operator op = defect_of("nebula", "nebula_as_printed", "the post on HDR of the Nebula engine",
                            "it does not divide by the luminance, so the picture is quadratic near "
                            "black and has no upper bound");
    op.differences = {{DocumentedDifference::Kind::exceeds_white, kInfinity, ""}};
    op.build = [](const Params&) -> Pipeline {
        const Expr luminance = Expr::input();
        const Expr scaled = named("scaled", luminance * (0.6 / 0.5));
        const Expr compressed =
            named("compressed", scaled * (1 + scaled / (16.0 * 16.0)) / (1 + scaled));
        return {limit_to_positive(), ToneScaleStage{ToneScaleStage::Norm::luminance, kRec709Weights,
                                                    compressed * luminance}};
    };
    return op;
}

Operator reinhard2() {
    Operator op;
    op.id = "reinhard2";
    op.title = "Reinhard2 (postprocessing)";
    op.view = "Reinhard2";
    op.character =
        "color times Reinhard Extended of its luminance, undivided: quadratic shadows, dark and "
        "hard";
    op.source =
        "postprocessing 6.39.6, ToneMappingEffect: REINHARD2 and REINHARD2_ADAPTIVE; three-stdlib "
        "2.36.1, ToneMapShader";
    op.license = "Zlib, MIT; formula and constants only; none of their code is used";
    op.negatives = kNegativesClampAtZero;
    op.dialects = "Reinhard";
    op.parameters = {
        number_parameter("middle_grey", "", 0.6, 0.01, 1, "scaled luminance of the average"),
        number_parameter("white", "scene-linear, after the scale", 4, 0.01, kHalfMax,
                         "scaled luminance at which the factor on the color is 1"),
        number_parameter("average", "scene-linear", 1, 1e-6, kHalfMax,
                         "mean luminance of the picture; REINHARD2 of the engine takes 1"),
        choice_parameter("clamp", {"yes", "no"}, "yes", "limit the result to [0, 1]")};
    op.presets = {{"three_stdlib",
                   "ToneMapShader of three-stdlib: white 16, not limited to 1",
                   {{"white", "16"}, {"clamp", "no"}}}};
    op.warnings = {
        "quadratic near black, because the engine does not divide by the luminance; "
        "reinhard_extended:luminance does"};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, kInfinity, "three_stdlib"}};
    op.build = [](const Params& p) -> Pipeline {
        const Expr luminance = Expr::input();
        const Expr white = p.expr("white");
        const Expr scaled =
            named("scaled", luminance * (p.expr("middle_grey") / p.expr("average")));
        const Expr factor = named("factor", scaled * (1 + scaled / (white * white)) / (1 + scaled));
        Pipeline stages = {limit_to_positive(), ToneScaleStage{ToneScaleStage::Norm::luminance,
                                                               kRec709Weights, luminance * factor}};
        if (p.choice("clamp") == "yes") stages.emplace_back(ClampStage{0, 1});
        return stages;
    };
    return op;
}

Operator jodie() {
    Operator op;
    op.id = "reinhard_jodie";
    op.title = "Reinhard-Jodie";
    op.view = "Reinhard Jodie";
    op.character =
        "luminance Reinhard in the shadows, per channel in the highlights: bright colors fade to "
        "white";
    op.source = "Jodie, shadertoy 4dBcD1, 2017: blend of eq. 3 on luminance and on channels";
    op.license = "published formula";
    op.negatives = kNegativesClampAtZero;
    op.dialects = "Reinhard";
    op.parameters = {weights_parameter({"rec709", "lygia"})};
    op.presets = {{"lygia", "tonemapReinhardJodie of lygia", {{"weights", "lygia"}}}};
    op.build = [](const Params& p) -> Pipeline {
        const Channels c = inputs();
        const Expr luminance = named("luminance", luminance_of(c, weights_of(p)));
        const auto channel = [&](const Expr& v) {
            const Expr t = named("t", v / (1 + v));
            return mix(named("by_luminance", v / (1 + luminance)), t, t);
        };
        return {limit_to_positive(), CrossTalkStage{{channel(c[0]), channel(c[1]), channel(c[2])}}};
    };
    return op;
}

Operator constant_luminance() {
    Operator op;
    op.id = "reinhard_constant_luminance";
    op.title = "Reinhard (constant luminance)";
    op.view = "Reinhard Constant Luminance";
    op.character =
        "luminance Reinhard that moves the excess of a channel to the other two: bright colors get "
        "paler instead of darker";
    op.source = "64, code/tonemapping of github.com/64/64.github.io (not in the article)";
    op.license = "MIT";
    op.negatives = kNegativesClampAtZero;
    op.dialects = "Reinhard";
    op.warnings = {
        "two channels above 1 lose the excess that they pass to each other, and its luminance"};
    op.bounds = {.lut3d = 0.25,
                 .reason =
                     "the slope jumps where a channel starts to pass on its excess, and no node of "
                     "a 3D LUT is there"};
    op.build = [](const Params&) -> Pipeline {
        const Channels c = inputs();  // scaled by 1/(1 + L)
        Channels handed_on = c;       // passed by channel i to each other one, at equal luminance
        for (std::size_t i = 0; i < 3; ++i) {
            const double w = kRec709Weights[i];
            handed_on[i] = max(c[i] - 1, 0) * (w / (1 - w));
        }
        const Expr x = Expr::input();
        const ToneScaleStage scale{ToneScaleStage::Norm::luminance, kRec709Weights, x / (1 + x)};
        // No channel exceeds 1/w, 13.9 for blue. One of the 65 nodes of a 3D LUT that ends at 16 is
        // at 1.00, where channels start to pass on their excess and the slope jumps.
        return {
            limit_to_positive(), scale, ClampStage{0, 16},
            CrossTalkStage{{c[0] + handed_on[1] + handed_on[2], c[1] + handed_on[2] + handed_on[0],
                            c[2] + handed_on[0] + handed_on[1]}}};
    };
    return op;
}

/// The paper's m from the key k of the picture: 0.3 + 0.7 k^1.4. A picture with a single luminance
/// has no key and gets the parameter's default.
double devlin_contrast(const SceneStatistics& s) {
    if (!(s.minimum_luminance > 0 && s.maximum_luminance > s.minimum_luminance)) return 0.6;
    const double k = (std::log(s.maximum_luminance) - std::log(s.log_average)) /
                     (std::log(s.maximum_luminance) - std::log(s.minimum_luminance));
    return 0.3 + 0.7 * std::pow(std::clamp(k, 0.0, 1.0), 1.4);
}

/// Response C/(C + (factor A)^contrast), with the adaptation A of pixel and picture.
struct Receptors {
    Expr factor, contrast, chromatic, light;
    Channels means;
    Expr mean_luminance;
    Vector3 weights = kRec709Weights;

    /// Adaptation of channel i to the picture.
    [[nodiscard]] Expr global(std::size_t i) const {
        return named("global_light", chromatic * means[i] + (1 - chromatic) * mean_luminance);
    }

    [[nodiscard]] Pipeline stages() const {
        // For grays the formula is x^(1-m)/(x^(1-m) + exp(-f m)), whose slope at black is infinite.
        // This power takes the infinite slope out of the 3D LUT.
        const Expr steepness = named("steepness", max(1 - contrast, 0.25));
        Channels in = inputs();
        for (Expr& channel : in)
            channel = named("scene", pow(channel, 1 / steepness));
        const Expr L = named("L", luminance_of(in, weights));
        Channels out = in;
        for (std::size_t i = 0; i < 3; ++i) {
            const Expr local = named("local_light", chromatic * in[i] + (1 - chromatic) * L);
            const Expr adaptation = named("adaptation", light * local + (1 - light) * global(i));
            out[i] = in[i] / (in[i] + pow(max(factor * adaptation, 0x1p-100), contrast));
        }
        return {curve_stage(pow(Expr::input(), steepness)), clamp_stage(pow(kHalfMax, steepness)),
                CrossTalkStage{out}};
    }

    /// The same without adaptation to the pixel.
    [[nodiscard]] Stage curve() const {
        CurveStage stage = curve_stage(0);
        for (std::size_t i = 0; i < 3; ++i) {
            const Expr x = Expr::input();
            stage.f[i] = x / (x + pow(max(factor * global(i), 0x1p-100), contrast));
        }
        return stage;
    }

    /// Largest channel of the response to (1, 1, 1).
    [[nodiscard]] Expr white() const {
        const auto response = [&](std::size_t i) {
            return 1 /
                   (1 + pow(max(factor * (light + (1 - light) * global(i)), 0x1p-100), contrast));
        };
        return max(max(response(0), response(1)), response(2));
    }
};

Operator devlin() {
    Operator op;
    op.id = "reinhard_devlin";
    op.title = "Reinhard-Devlin";
    op.view = "Reinhard Devlin";
    op.character =
        "model of the eye's receptors: very flat and bright, lifts black steeply; colors stay, or "
        "fade with chromatic_adaptation";
    op.source =
        "E. Reinhard, K. Devlin, Dynamic Range Reduction Inspired by Photoreceptor Physiology, "
        "IEEE Transactions on Visualization and Computer Graphics 11(1), 2005";
    op.license = "published formula";
    op.negatives = kNegativesClampAtZero;
    op.dialects = "Reinhard";
    const auto mean = [](std::string name, std::string statistic, std::string help,
                         double (*from_picture)(const SceneStatistics&)) {
        return statistic_parameter(
            number_parameter(std::move(name), "scene-linear", 0.5, 0, kHalfMax, std::move(help)),
            std::move(statistic), from_picture);
    };
    op.parameters = {
        number_parameter("intensity", "", 0, -8, 8,
                         "f: brightness; scales the adaptation by exp(-f)"),
        statistic_parameter(
            number_parameter("contrast", "", 0.6, 0.3, 1,
                             "m: power of the adaptation; larger has more contrast"),
            "0.3 + 0.7 k^1.4 of the key k", devlin_contrast),
        number_parameter(
            "chromatic_adaptation", "", 0, 0, 1,
            "c: 0 adapts all channels to the luminance, 1 adapts each channel to itself"),
        number_parameter("light_adaptation", "", 1, 0, 1,
                         "a: 0 adapts to the means of the picture, 1 to the pixel"),
        mean("mean_red", "mean red", "mean of the picture; only with light_adaptation below 1",
             [](const SceneStatistics& s) { return s.mean_rgb[0]; }),
        mean("mean_green", "mean green", "mean of the picture; only with light_adaptation below 1",
             [](const SceneStatistics& s) { return s.mean_rgb[1]; }),
        mean("mean_blue", "mean blue", "mean of the picture; only with light_adaptation below 1",
             [](const SceneStatistics& s) { return s.mean_rgb[2]; }),
        mean("mean_luminance", "mean luminance",
             "mean of the picture; only with light_adaptation below 1",
             [](const SceneStatistics& s) { return s.mean_luminance; })};
    op.warnings = {"contrast=1 with light_adaptation=1 shows all grays except black alike"};
    op.differences = {{DocumentedDifference::Kind::never_reaches_white, 0.99, ""}};
    op.bounds.lut3d = 0.05;
    op.bounds.reason =
        "infinite slope at black, and half floats end at 6e-8; elsewhere the error of a 3D LUT";
    op.build = [](const Params& p) -> Pipeline {
        const Receptors receptors{
            .factor = exp(-p.expr("intensity")),
            .contrast = p.expr("contrast"),
            .chromatic = p.expr("chromatic_adaptation"),
            .light = p.expr("light_adaptation"),
            .means = {p.expr("mean_red"), p.expr("mean_green"), p.expr("mean_blue")},
            .mean_luminance = p.expr("mean_luminance")};
        return Pipeline{limit_to_positive()} + receptors.stages();
    };
    return op;
}

Operator opencv() {
    Operator op;
    op.id = "opencv_reinhard";
    op.title = "Reinhard-Devlin (OpenCV)";
    op.view = "OpenCV Reinhard";
    op.character =
        "Reinhard-Devlin between two stretches to the range of the picture: its minimum becomes "
        "black, its maximum white";
    op.source = "OpenCV 4.6.0, photo, TonemapReinhard; after Reinhard and Devlin 2005";
    op.license = "Apache-2.0; formula and constants only; none of its code is used";
    op.negatives = kNegativesClampAtZero;
    op.dialects = "Reinhard";
    const auto of_picture = [](std::string name, double value, std::string statistic,
                               std::string help, double (*from_picture)(const SceneStatistics&)) {
        return statistic_parameter(
            number_parameter(std::move(name), "scene-linear", value, 0, kHalfMax, std::move(help)),
            std::move(statistic), from_picture);
    };
    const std::string mean_help = "mean of the picture; only with light_adaptation below 1";
    op.parameters = {
        number_parameter("intensity", "", 0, -8, 8,
                         "f: brightness; scales the adaptation by exp(-f)"),
        fixed_parameters(
            {number_parameter("light_adaptation", "", 1, 0, 1,
                              "0 adapts to the means of the picture, 1 to the pixel")})[0],
        number_parameter("color_adaptation", "", 0, 0, 1,
                         "0 adapts all channels to the gray, 1 adapts each channel to itself"),
        smallest_channel_parameter(),
        largest_channel_parameter(),
        statistic_parameter(
            number_parameter("contrast", "", 0.6, 0.3, 1,
                             "m: power of the adaptation; larger has more contrast"),
            "0.3 + 0.7 k^1.4 of the key k", devlin_contrast),
        of_picture("mean_red", 0.5, "mean red", mean_help,
                   [](const SceneStatistics& s) { return s.mean_rgb[0]; }),
        of_picture("mean_green", 0.5, "mean green", mean_help,
                   [](const SceneStatistics& s) { return s.mean_rgb[1]; }),
        of_picture("mean_blue", 0.5, "mean blue", mean_help,
                   [](const SceneStatistics& s) { return s.mean_rgb[2]; }),
        of_picture("mean_gray", 0.5, "mean of 0.114 R + 0.587 G + 0.299 B", mean_help,
                   [](const SceneStatistics& s) {
                       return kOpencvWeights[0] * s.mean_rgb[0] +
                              kOpencvWeights[1] * s.mean_rgb[1] + kOpencvWeights[2] * s.mean_rgb[2];
                   }),
        number_parameter("output_minimum", "", 0, 0, 1,
                         "smallest channel of the result before it is stretched"),
        number_parameter("output_maximum", "", 0, 0, 1,
                         "largest channel of the result before it is stretched (0: that of a pixel "
                         "whose channels are all the maximum)")};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, 1.98, ""}};
    op.bounds.lut3d = 0.05;
    op.bounds.reason =
        "infinite slope at black, and half floats end at 6e-8; elsewhere the error of a 3D LUT";
    op.build = [](const Params& p) -> Pipeline {
        const Expr minimum = p.expr("minimum");
        const Expr span = named("span", p.expr("maximum") - minimum);
        if (fails(less(0, span))) {
            throw Error("maximum is " + shortest(p.expr("maximum").value()) +
                        "; expected above minimum, " + shortest(minimum.value()));
        }
        const auto normalized = [&](const char* name) { return (p.expr(name) - minimum) / span; };
        const Receptors receptors{
            .factor = exp(-p.expr("intensity")),
            .contrast = p.expr("contrast"),
            .chromatic = p.expr("color_adaptation"),
            .light = p.number("light_adaptation"),
            .means = {normalized("mean_red"), normalized("mean_green"), normalized("mean_blue")},
            .mean_luminance = normalized("mean_gray"),
            .weights = kOpencvWeights};
        const Expr given = p.expr("output_maximum");
        const Expr low = p.expr("output_minimum");
        const Expr high = named("high", select(less(0, given), given, receptors.white()));
        if (fails(less(low, high))) {
            throw Error("output_minimum is " + shortest(low.value()) +
                        "; expected below output_maximum, " + shortest(high.value()));
        }
        const Expr x = Expr::input();
        const Pipeline response =
            p.number("light_adaptation") == 0 ? Pipeline{receptors.curve()} : receptors.stages();
        return Pipeline{limit_to_positive(), curve_stage((x - minimum) / span),
                        ClampStage{0, kHalfMax}} +
               response + Pipeline{curve_stage((x - low) / (high - low))};
    };
    return op;
}

}  // namespace

std::vector<Operator> define_reinhard() {
    return {simple(),
            extended(),
            nebula(),
            nebula_as_printed(),
            reinhard2(),
            jodie(),
            constant_luminance(),
            devlin(),
            opencv()};
}

TONEWRIGHT_NAMESPACE_END
