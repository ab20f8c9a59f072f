// SPDX-License-Identifier: Apache-2.0
//
// Gran Turismo 7: the curve of 2017 with a new shoulder, per channel, blended with a version that
// keeps the chroma of ICtCp.
//
// Source    K. Yasutomi, K. Suzuki, H. Uchimura, "Driving Toward Reality: Physically Based Tone
//           Mapping and Perceptual Fidelity in Gran Turismo 7", SIGGRAPH 2025 course; sample code
//           gt7_tone_mapping.cpp 1.0, Polyphony Digital 2025 (its ICtCp variant).
// In        scene-linear RGB, working primaries Rec.2020, D65; 1.0 = 100 cd/m2; domain [0, inf),
//           negatives clamped at 0 (the toe has a power).
// Out       output=sdr: display-linear RGB, 1.0 = display peak, assumed to be 250 cd/m2; [0, 1].
//           output=hdr: units of 100 cd/m2; [0, peak/100].
// Kind      3D. Monotone on the neutral axis: yes; it reaches the peak with a corner at 1.4717
//           times the peak, and is constant above.
// Keeps     0 -> 0; grays from 0.538 up to 0.444 of the peak.
// Differs   nowhere. Like the source, it limits the PQ code to [0, 1] before decoding: dark
//           saturated colors are below 0 there, bright ones of a high peak above 1. The matrices
//           from ICtCp have the source's six digits and are not exact inverses: they tint grays by
//           about 1e-6.
// Check     mid gray 0.18 in Rec.2020 -> red 0.0579497689 (sdr), 0.144874422 (hdr)
//           (check_values.json).
#include <algorithm>
#include <cmath>

#include "base/format_number.h"
#include "operators/family.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// clang-format off
/// ITU-R BT.2100-2, tables 6 and 7.
constexpr Matrix3 kRgbToLms = {{{1688.0 / 4096, 2146.0 / 4096,  262.0 / 4096},
                                { 683.0 / 4096, 2951.0 / 4096,  462.0 / 4096},
                                {  99.0 / 4096,  309.0 / 4096, 3688.0 / 4096}}};
constexpr Matrix3 kLmsToIctcp = {{{ 2048.0 / 4096,   2048.0 / 4096,    0.0},
                                  { 6610.0 / 4096, -13613.0 / 4096, 7003.0 / 4096},
                                  {17933.0 / 4096, -17390.0 / 4096, -543.0 / 4096}}};
/// The inverses that the sample code prints.
constexpr Matrix3 kIctcpToLms = {{{1.0,  0.00860904,  0.11103},
                                  {1.0, -0.00860904, -0.11103},
                                  {1.0,  0.560031,   -0.320627}}};
constexpr Matrix3 kLmsToRgb = {{{ 3.43661,   -2.50645,    0.0698454},
                                {-0.79133,    1.9836,    -0.192271},
                                {-0.0259499, -0.0989137,  1.12486}}};
// clang-format on

constexpr double kReferenceLuminance = 100;  // cd/m2 of 1.0

Pipeline to_ictcp() {
    return {MatrixStage{kRgbToLms, "rgb_to_lms"},
            curve_stage(pq_encode_nits(kReferenceLuminance * Expr::input())),
            MatrixStage{kLmsToIctcp, "lms_to_ictcp"}};
}

Pipeline from_ictcp() {
    const Expr code = clamp(Expr::input(), 0, 1);
    return {MatrixStage{kIctcpToLms, "ictcp_to_lms"},
            curve_stage(pq_decode_nits(code) / kReferenceLuminance),
            MatrixStage{kLmsToRgb, "lms_to_rgb"}, ClampStage{0, kInfinity}};
}

/// The source's "curve V2": toe, straight line, exponential shoulder.
/// @param peak  in units of 100 cd/m2.
Expr gt7_curve(double peak) {
    constexpr double alpha = 0.25;  // convergence
    constexpr double mid = 0.538;
    constexpr double linear = 0.444;
    constexpr double toe = 1.28;
    constexpr double k = (linear - 1) / (alpha - 1);
    const double a = peak * linear + peak * k;
    const double b = -peak * k * std::exp(linear / k);
    const double c = -1 / (k * peak);
    const Expr x = Expr::input();
    const Expr line_weight = named("line_weight", smoothstep(0, mid, x));
    const Expr below =
        named("below", (1 - line_weight) * (mid * pow(x / mid, toe)) + line_weight * x);
    return select(less(x, linear * peak), below, a + b * exp(c * x));
}

CrossTalkStage gt7_mapping(double peak) {
    const Expr f = gt7_curve(peak);
    const std::array<Expr, 3> skewed = compose({curve_stage(f)});
    const std::array<Expr, 3> in = compose(to_ictcp());
    const Expr intensity = compose(Pipeline{curve_stage(f)} + to_ictcp())[0];
    const double white = pq_encode_nits(kReferenceLuminance * peak).value();
    const Expr chroma = named("chroma", 1 - smoothstep(0.98, 1.16, in[0] / white));
    std::array<Expr, 3> kept = {named("intensity", intensity), named("ct", in[1] * chroma),
                                named("cp", in[2] * chroma)};
    for (const Stage& stage : from_ictcp())
        kept = apply_stage(stage, kept);
    CrossTalkStage mapping{skewed};
    for (std::size_t i = 0; i < 3; ++i)
        mapping.f[i] = mix(named("skewed", skewed[i]), named("kept", kept[i]), 0.6);
    return mapping;
}

}  // namespace

std::vector<Operator> define_gt7() {
    Operator op;
    op.id = "gt7";
    op.title = "Gran Turismo 7";
    op.view = "Gran Turismo 7";
    op.character =
        "filmic and clean, highlights keep their hue and lose chroma only near the peak; dark "
        "unless scene-linear 1 stands for 100 cd/m2";
    op.source =
        "Yasutomi, Suzuki, Uchimura, Driving Toward Reality: Physically Based Tone Mapping and "
        "Perceptual Fidelity in Gran Turismo 7, SIGGRAPH 2025; gt7_tone_mapping.cpp 1.0";
    op.license = "MIT";
    op.negatives = kNegativesClampAtZero;
    op.dialects = "Gran Turismo";
    op.bounds = {.lut3d = 0.26, .reason = "3D LUT: highlights lose their chroma within 1.4 stops"};
    op.working = kRec2020;
    op.parameters = fixed_parameters({
        sdr_or_hdr_parameter("sdr: 1 is the peak of a display of 250 cd/m2; hdr: 1 is 100 cd/m2"),
        display_parameter(number_parameter("peak", "cd/m2", 1000, 250, 10000,
                                           "peak luminance of the display; only with output=hdr"),
                          [](const DisplayFacts& display) -> std::string {
                              return display.is_hdr ? shortest(std::max(display.peak, 250.0)) : "";
                          }),
    });
    op.presets = {{"hdr", "HDR display, in units of 100 cd/m2", {{"output", "hdr"}}}};
    op.warnings = {
        "scene-linear 1 stands for 100 cd/m2: expose about 1.3 stops more than for "
        "operators that show 1 near white",
        "SDR displays clip output=hdr at 100 cd/m2"};
    op.differences = {{DocumentedDifference::Kind::exceeds_white, 10, "hdr"}};
    op.peak = [](const Params& p) {
        return p.choice("output") == "hdr" ? p.number("peak") / kReferenceLuminance : 1;
    };
    op.build = [](const Params& p) -> Pipeline {
        const bool is_hdr = p.choice("output") == "hdr";
        const double peak = is_hdr ? p.number("peak") / kReferenceLuminance : 2.5;
        const double factor = is_hdr ? 1 : 1 / peak;
        return {limit_to_positive(), gt7_mapping(peak), ClampStage{0, peak},
                MatrixStage{scale(kIdentity3, factor)}};
    };
    return {op};
}

TONEWRIGHT_NAMESPACE_END
