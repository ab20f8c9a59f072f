// SPDX-License-Identifier: Apache-2.0
//
// Operators of the 1990s and 2000s that measure the picture: its log mean, its maximum, and the
// eye's adaptation to it.
//
// Source    drago: F. Drago, K. Myszkowski, T. Annen, N. Chiba, "Adaptive Logarithmic Mapping for
//           Displaying High Contrast Scenes", Computer Graphics Forum 22(3), Eurographics 2003.
//           drago:pfstmo: pfstmo 2.2.0, pfstmo_drago03. opencv_drago: OpenCV 4.6.0, photo,
//           TonemapDrago. Both were executed.
//           ward: G. Ward, "A Contrast-Based Scalefactor for Luminance Display", Graphics Gems IV,
//           1994, pp. 415-421. tumblin_rushmeier: J. Tumblin, H. Rushmeier, "Tone Reproduction for
//           Realistic Images", IEEE Computer Graphics and Applications 13(6), 1993, pp. 42-48.
//           ferwerda: J. Ferwerda, S. Pattanaik, P. Shirley, D. Greenberg, "A Model of Visual
//           Adaptation for Realistic Image Synthesis", SIGGRAPH 1996.
//           durand_dorsey_rods: F. Durand, J. Dorsey, "Interactive Tone Mapping", Eurographics
//           Workshop on Rendering, 2000.
// In        scene-linear RGB, working primaries Rec.709, D65; domain [0, 65504], negatives clamped
//           at 0. ward, tumblin_rushmeier, ferwerda and durand_dorsey_rods read scene values as
//           cd/m2.
// Out       display-linear RGB, 1.0 = display peak. No operator clamps, and all are unbounded above
//           it.
// Kind      luminance, or as `apply` chooses; the two with rods mix the channels (matrix, curve,
//           matrix). Monotone on the neutral axis: yes.
// Keeps     0 -> 0, except tumblin_rushmeier f(0) = -1/contrast_max; drago maximum ->
//           display_max/100.
// Differs   luminance variants are 0/0 at black in every source; here black stays black.
//           drago: the display's encoding replaces the paper's changed gamma. ln(1 + x) keeps its
//           digits for small x, and the bias power ends at 2^-100 of the maximum, because its slope
//           is infinite at 0.
//           opencv_drago: OpenCV measures minimum and maximum twice, before and after the curve.
//           The second pair is a parameter, because no statistic of the scene gives it. Its
//           statistics of gray have the weights 0.114, 0.587, 0.299 and values of at least 1e-4 of
//           the maximum; `apply` fills in those of relative luminance. tumblin_rushmeier: luminance
//           and max variants show negative output as black. ferwerda, durand_dorsey_rods: the rods'
//           signal -0.702 X + 1.039 Y + 0.433 Z is negative for saturated reds; here it is 0 there.
//           k is limited to [0, 1] before it is squared (T. Zeltner's "Tone Mapper" squares first,
//           so bright scenes get night vision).
// Check     mid gray 0.18 -> 0.0616409117 (drago), 0.0302864674 (ward), 0.0424389891
//           (tumblin_rushmeier); (0.05, 0.1, 2) -> (0.0241295151, 0.0273945785, 0.151466987)
//           (ferwerda, rod_weight 0.5), (0.0251727377, 0.0267686450, 0.157100389)
//           (durand_dorsey_rods, rod_weight 0.5) (python_check/operators/statistics.py).
#include <algorithm>
#include <cmath>

#include "base/format_number.h"
#include "operators/family.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr const char* kChannelsMayClip =
    "apply=luminance keeps chromaticity, so a saturated channel may exceed 1 and clip";
constexpr const char* kScenesAreLuminances =
    "reads scene values as cd/m2: the absolute level of the picture changes its contrast or colors";

ParameterSpec log_average(double value) {
    return statistic_parameter(
        number_parameter("log_average", "scene-linear", value, 1e-6, kHalfMax,
                         "geometric mean luminance of the scene, to which the eye has adapted"),
        "log mean luminance", [](const SceneStatistics& s) { return s.log_average; });
}

ParameterSpec display_max(double value) {
    return number_parameter("display_max", "cd/m2", value, 1, 10000,
                            "luminance of the display's white");
}

Operator drago() {
    Operator op;
    op.id = "drago";
    op.title = "Drago";
    op.view = "Drago";
    op.character =
        "logarithm whose base grows with luminance: opens shadows, keeps highlights distinct, gray "
        "midtones";
    op.source =
        "F. Drago, K. Myszkowski, T. Annen, N. Chiba, Adaptive Logarithmic Mapping for Displaying "
        "High Contrast Scenes, Computer Graphics Forum 22(3), Eurographics 2003, eq. 4";
    op.license = "published formula";
    op.negatives = kNegativesClampAtZero;
    op.dialects = "Drago";
    op.parameters = with_apply(
        "luminance",
        {number_parameter("bias", "", 0.85, 0.5, 1,
                          "b: smaller is brighter and flatter; also scales the log average, by "
                          "(1 + b - 0.85)^-5"),
         choice_parameter("bias_scales_average", {"yes", "no"}, "yes",
                          "yes: as in the paper; no: as in pfstmo"),
         number_parameter("display_max", "cd/m2", 100, 1, 10000,
                          "luminance at which the maximum is shown; display white is 100"),
         log_average(1),
         statistic_parameter(number_parameter("maximum", "scene-linear", 100, 1e-6, kHalfMax,
                                              "highest scene luminance"),
                             "maximum luminance",
                             [](const SceneStatistics& s) { return s.maximum_luminance; })});
    op.presets = {{"pfstmo",
                   "pfstmo_drago03, whose bias does not scale the average",
                   {{"bias_scales_average", "no"}}}};
    op.warnings = {kChannelsMayClip};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, 1.5, ""}};
    op.build = [](const Params& p) -> Pipeline {
        const Expr bias = p.expr("bias");
        const Expr maximum = p.expr("maximum");
        const Expr average = p.expr("log_average");
        const Expr adaptation = p.choice("bias_scales_average") == "yes"
                                    ? named("adaptation", average / pow(1 + bias - 0.85, 5))
                                    : average;
        const Expr at_maximum =
            named("at_maximum", log_of_1_plus(maximum / adaptation) / std::log(10.0));
        const Expr exponent = named("exponent", log(bias) / std::log(0.5));
        const Expr L = Expr::input();
        const Expr base = named("base", 2 + 8 * pow(max(L / maximum, 0x1p-100), exponent));
        const Expr f = (p.expr("display_max") / 100 / at_maximum) *
                       (log_of_1_plus(L / adaptation) / log(base));
        return tone_curve_pipeline({.f = f}, p);
    };
    return op;
}

Operator opencv_drago() {
    Operator op;
    op.id = "opencv_drago";
    op.title = "Drago (OpenCV)";
    op.view = "OpenCV Drago";
    op.character =
        "Drago between two stretches to the range of the picture: its minimum becomes black, its "
        "maximum white";
    op.source = "OpenCV 4.6.0, photo, TonemapDrago; after Drago, Myszkowski, Annen, Chiba 2003";
    op.license = "Apache-2.0; formula and constants only; none of its code is used";
    op.negatives = kNegativesClampAtZero;
    op.dialects = "Drago";
    op.parameters = with_apply(
        "luminance",
        {number_parameter("bias", "", 0.85, 0.5, 1, "b: smaller is brighter and flatter"),
         smallest_channel_parameter(), largest_channel_parameter(), log_average(0.5),
         statistic_parameter(number_parameter("maximum_gray", "scene-linear", 1, 1e-6, kHalfMax,
                                              "largest 0.114 R + 0.587 G + 0.299 B of the picture"),
                             "maximum luminance",
                             [](const SceneStatistics& s) { return s.maximum_luminance; }),
         number_parameter("output_minimum", "", 0, 0, 100,
                          "smallest channel of the result before it is stretched"),
         number_parameter("output_maximum", "", 0, 0, kHalfMax,
                          "largest channel of the result before it is stretched (0: that of "
                          "the largest gray)")});
    op.warnings = {kChannelsMayClip};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, 5.3, ""}};
    op.build = [](const Params& p) -> Pipeline {
        const Expr minimum = p.expr("minimum");
        const Expr span = named("span", p.expr("maximum") - minimum);
        const Expr average = named("average", (p.expr("log_average") - minimum) / span);
        const Expr largest = named("largest", (p.expr("maximum_gray") - minimum) / span);
        if (fails(less(0, span)) || fails(less(0, average)) || fails(less(0, largest))) {
            throw Error("minimum is " + shortest(minimum.value()) +
                        "; expected below maximum, log_average and maximum_gray");
        }
        const Expr exponent = named("exponent", log(p.expr("bias")) / std::log(0.5));
        const Expr given = p.expr("output_maximum");
        const Expr low = p.expr("output_minimum");
        const Expr at_largest =
            named("at_largest", log_of_1_plus(largest / average) / std::log(10.0));
        const Expr high = named("high", select(less(0, given), given, at_largest));
        if (fails(less(low, high))) {
            throw Error("output_minimum is " + shortest(low.value()) +
                        "; expected below output_maximum, " + shortest(high.value()));
        }
        const Expr x = Expr::input();
        const Expr base = named("base", 2 + 8 * pow(max(x / largest, 0x1p-100), exponent));
        const ToneCurve curve{.f = log_of_1_plus(x / average) / log(base),
                              .weights = kOpencvWeights};
        return Pipeline{limit_to_positive(), curve_stage((x - minimum) / span),
                        ClampStage{0, kHalfMax}} +
               apply_tone_curve(curve, p) + Pipeline{curve_stage((x - low) / (high - low))};
    };
    return op;
}

Operator ward() {
    Operator op;
    op.id = "ward";
    op.title = "Ward (contrast-based scale factor)";
    op.view = "Ward";
    op.character =
        "one factor for the whole picture: just visible differences of the scene stay just visible "
        "on the display; clips highlights";
    op.source =
        "G. Ward, A Contrast-Based Scalefactor for Luminance Display, Graphics Gems IV, 1994, "
        "pp. 415-421";
    op.license = "published formula";
    op.negatives = kNegativesClampAtZero;
    op.parameters = with_apply("luminance", {display_max(80), log_average(0.5)});
    op.warnings = {kScenesAreLuminances};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, kInfinity, ""}};
    op.build = [](const Params& p) -> Pipeline {
        const Expr display = p.expr("display_max");
        const Expr threshold_ratio =
            (1.219 + pow(display / 2, 0.4)) / (1.219 + pow(p.expr("log_average"), 0.4));
        const Expr m = named("m", pow(threshold_ratio, 2.5));
        return tone_curve_pipeline({.f = (m / display) * Expr::input()}, p);
    };
    return op;
}

/// Tumblin and Rushmeier's fit to Stevens' and Stevens' brightness, for an eye adapted to La cd/m2:
/// log10 of the brightness is alpha log10(L) + beta.
struct Brightness {
    Expr alpha, beta;
};

Brightness brightness_of(const Expr& La) {
    const Expr log_adaptation = named("log_adaptation", log2(La) * std::log10(2.0) + 0.84);
    return {0.4 * log_adaptation + 2.92,
            -0.4 * log_adaptation * log_adaptation - 2.584 * log_adaptation + 2.0208};
}

Operator tumblin_rushmeier() {
    Operator op;
    op.id = "tumblin_rushmeier";
    op.title = "Tumblin-Rushmeier";
    op.view = "Tumblin-Rushmeier";
    op.character =
        "matches the perceived brightness of display and scene: night scenes get darker and "
        "flatter; crushes black, clips highlights";
    op.source =
        "J. Tumblin, H. Rushmeier, Tone Reproduction for Realistic Images, IEEE Computer Graphics "
        "and Applications 13(6), 1993, pp. 42-48";
    op.license = "published formula";
    op.negatives = kNegativesClampAtZero;
    op.parameters = with_apply("luminance",
                               {display_max(80),
                                number_parameter("contrast_max", "", 36, 2, 10000,
                                                 "contrast of the display: white divided by black"),
                                log_average(0.5)});
    op.warnings = {kScenesAreLuminances};
    op.differences = {{DocumentedDifference::Kind::crushes_black, 0.060, ""},
                      {DocumentedDifference::Kind::exceeds_white, kInfinity, ""}};
    op.build = [](const Params& p) -> Pipeline {
        const Expr display = p.expr("display_max");
        const Expr contrast = p.expr("contrast_max");
        const Brightness of_scene = brightness_of(p.expr("log_average"));
        const Brightness of_display = brightness_of(display / sqrt(contrast));
        const Expr scale =
            named("scale", pow(10, (of_scene.beta - of_display.beta) / of_display.alpha) / display);
        const Expr f = scale * pow(Expr::input(), of_scene.alpha / of_display.alpha) - 1 / contrast;
        return tone_curve_pipeline({.f = f}, p);
    };
    return op;
}

// ---------------------------------------------------------------------------------------------
// Cones and rods

/// Response of the rods to red, green and blue: -0.702 X + 1.039 Y + 0.433 Z, with the XYZ of
/// Rec.709.
constexpr Vector3 kRods = {-0.702 * 0.412453 + 1.039 * 0.212671 + 0.433 * 0.019334,
                           -0.702 * 0.357580 + 1.039 * 0.715160 + 0.433 * 0.119193,
                           -0.702 * 0.180423 + 1.039 * 0.072169 + 0.433 * 0.950227};

double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Smallest luminance difference visible to cones adapted to La cd/m2.
Expr cone_threshold(const Expr& La) {
    const Expr l = log2(La) * std::log10(2.0);
    const Expr middle = pow(max(0.249 * l + 0.65, 0), 2.7) - 0.72;
    return pow(10,
               select(less_equal(l, -2.6), -0.72, select(less_equal(1.9, l), l - 1.255, middle)));
}

/// The same for rods.
Expr rod_threshold(const Expr& La) {
    const Expr l = log2(La) * std::log10(2.0);
    const Expr middle = pow(max(0.405 * l + 1.6, 0), 2.18) - 2.86;
    return pow(
        10, select(less_equal(l, -3.94), -2.86, select(less_equal(-1.44, l), l - 0.395, middle)));
}

/// C' = cones C + rods tint max(dot(kRods, C), 0).
Pipeline cones_and_rods(const Expr& cones, const Expr& rods, const Vector3& tint) {
    const Expr x = Expr::input();
    // Choose coordinates in which one is the rods' signal and the others do not change along the
    // tint. Only the signal has a nonlinear curve, so matrix, curve, matrix is exact.
    const auto p =
        static_cast<std::size_t>(std::max_element(tint.begin(), tint.end()) - tint.begin());
    const double along_tint = dot(kRods, tint);
    if (std::fabs(along_tint) > 0.1 * tint[p]) {
        Matrix3 basis = kIdentity3;
        for (std::size_t i = 0; i < 3; ++i)
            basis[i][p] = -tint[i] / tint[p];
        basis[p] = kRods;
        CurveStage response = curve_stage(cones * x);
        response.f[p] = cones * x + rods * along_tint * max(x, 0);
        return {limit_to_positive(), MatrixStage{basis}, response, MatrixStage{inverse(basis)}};
    }
    // The rods hardly respond to their own tint, so these coordinates do not exist.
    const std::array<Expr, 3> c = {Expr::input(0), Expr::input(1), Expr::input(2)};
    const Expr signal =
        named("signal", max(kRods[0] * c[0] + kRods[1] * c[1] + kRods[2] * c[2], 0));
    const auto channel = [&](std::size_t i) { return cones * c[i] + rods * tint[i] * signal; };
    return {limit_to_positive(), CrossTalkStage{{channel(0), channel(1), channel(2)}}};
}

std::vector<ParameterSpec> rod_parameters() {
    return {
        display_max(80),
        statistic_parameter(number_parameter("photopic_adaptation", "cd/m2", 2, 1e-6, kHalfMax,
                                             "luminance to which the cones have adapted"),
                            "half the maximum luminance",
                            [](const SceneStatistics& s) { return s.maximum_luminance / 2; }),
        statistic_parameter(number_parameter("scotopic_adaptation", "scotopic cd/m2", 1.5, 1e-6,
                                             kHalfMax, "rod signal to which the rods have adapted"),
                            "half the rod signal of the channel maxima",
                            [](const SceneStatistics& s) { return dot(kRods, s.maximum_rgb) / 2; }),
        choice_parameter("rod_weight_from", {"adaptation", "fixed"}, "adaptation",
                         "source of the rods' share: the adaptation of the eye, or rod_weight"),
        number_parameter("rod_weight", "", 0.5, 0, 1,
                         "k: share of the rods; only with rod_weight_from=fixed")};
}

/// C' = (mp C + k ms tint Ls)/Ldmax.
Pipeline rod_pipeline(const Params& p, const Expr& weight_by_adaptation, const Vector3& tint) {
    const Expr display = p.expr("display_max");
    const Expr threshold = cone_threshold(display / 2);
    const Expr mp = threshold / cone_threshold(p.expr("photopic_adaptation"));
    const Expr ms = threshold / rod_threshold(p.expr("scotopic_adaptation"));
    const Expr k =
        p.choice("rod_weight_from") == "fixed" ? p.expr("rod_weight") : weight_by_adaptation;
    return cones_and_rods(named("cones", mp / display), named("rods", k * ms / display), tint);
}

DeclaredBounds rod_bounds() {
    return {.simd = 2e-6,
            .ocio_cpu = 1.5e-4,
            .ocio_gpu = 6e-3,
            .lut3d = 0.3,
            .reason = "the matrix from the rods' coordinates to RGB cancels near black"};
}

Operator ferwerda() {
    Operator op;
    op.id = "ferwerda";
    op.title = "Ferwerda";
    op.view = "Ferwerda";
    op.character =
        "just visible differences of the scene stay just visible on the display; dark scenes turn "
        "to the gray of the rods; clips highlights";
    op.source =
        "J. Ferwerda, S. Pattanaik, P. Shirley, D. Greenberg, A Model of Visual Adaptation for "
        "Realistic Image Synthesis, SIGGRAPH 1996";
    op.license = "published formula";
    op.negatives = kNegativesClampAtZero;
    op.dialects = "Ferwerda";
    op.parameters = rod_parameters();
    op.bounds = rod_bounds();
    op.warnings = {kScenesAreLuminances};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, kInfinity, ""}};
    op.build = [](const Params& p) -> Pipeline {
        const Expr La = p.expr("photopic_adaptation");
        const Expr k = min(max(1 - (La / 2 - 0.01) / (10 - 0.01), 0), 1);
        return rod_pipeline(p, k * k, {1, 1, 1});
    };
    return op;
}

Operator durand_dorsey_rods() {
    Operator op;
    op.id = "durand_dorsey_rods";
    op.title = "Ferwerda with blue shift (Durand-Dorsey)";
    op.view = "Durand-Dorsey Rods";
    op.character =
        "Ferwerda with bluish night scenes; the share of the rods falls more slowly with luminance";
    op.source =
        "F. Durand, J. Dorsey, Interactive Tone Mapping, Eurographics Workshop on "
        "Rendering, 2000";
    op.license = "published formula";
    op.negatives = kNegativesClampAtZero;
    op.dialects = "Ferwerda";
    op.parameters = rod_parameters();
    op.bounds = rod_bounds();
    const auto shift = [&](const std::string& color, double value) {
        op.parameters.push_back(fixed_parameters({number_parameter(
            "blue_shift_" + color, "", value, 0, 2, color + " of the rods' gray")})[0]);
    };
    shift("red", 1.05);
    shift("green", 0.97);
    shift("blue", 1.27);
    op.warnings = {kScenesAreLuminances};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, kInfinity, ""},
                      {DocumentedDifference::Kind::tints_gray, 0.049, ""}};
    op.build = [](const Params& p) -> Pipeline {
        const Expr La = p.expr("scotopic_adaptation");
        const Expr k = max((100 - La / 4) / (100 + La), 0);
        return rod_pipeline(p, k * k,
                            {p.number("blue_shift_red"), p.number("blue_shift_green"),
                             p.number("blue_shift_blue")});
    };
    return op;
}

}  // namespace

std::vector<Operator> define_statistics() {
    return {drago(), opencv_drago(), ward(), tumblin_rushmeier(), ferwerda(), durand_dorsey_rods()};
}

TONEWRIGHT_NAMESPACE_END
