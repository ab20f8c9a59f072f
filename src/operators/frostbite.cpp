// SPDX-License-Identifier: Apache-2.0
//
// Frostbite: hue-preserving range compression with some of the per-channel look.
//
// Source    A. Fry, "High Dynamic Range Color Grading and Display in Frostbite", GDC 2017;
//           constants of T. Stachowiak's shadertoy after it.
// In        scene-linear RGB, working primaries Rec.709, D65; 1.0 = 100 cd/m2; domain [0, inf),
//           negatives clamped at 0 (PQ has powers).
// Out       display-linear RGB, 1.0 = display peak; not clamped: saturated colors reach about 1.1,
//           and slightly below 0.
// Kind      3D. Monotone on the neutral axis: yes, except for the tint of grays (the printed
//           matrices do not map white to Ct = Cp = 0). It grows to 4e-4 near white and lowers red
//           by up to 1e-6 per 1/64 stop.
// Keeps     0 -> 0; grays up to linear_end, except for that tint.
// Differs   The source divides by the largest channel, also if it is 0; here the ratio is 1 there,
//           as everywhere below linear_end. smoothstep with falling edges, undefined in GLSL, uses
//           its formula. The inverses of the matrices are computed, because the published ones are
//           rounded.
// Check     mid gray 0.18 -> red 0.179998742, (0.8, 0.1, 0.05) -> red 0.636523412
//           (check_values.json).
#include "operators/family.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// clang-format off
/// Linear sRGB to XYZ as B. Lindbloom prints it.
constexpr Matrix3 kRgbToXyz = {{{0.4124564, 0.3575761, 0.1804375},
                                {0.2126729, 0.7151522, 0.0721750},
                                {0.0193339, 0.1191920, 0.9503041}}};
/// ICtCp as Dolby's white paper of 2016 prints it.
constexpr Matrix3 kXyzToLms = {{{ 0.3592, 0.6976, -0.0358},
                                {-0.1922, 1.1004,  0.0755},
                                { 0.0070, 0.0749,  0.8434}}};
constexpr Matrix3 kLmsToIctcp = {{{0.5,     0.5,     0.0},
                                  {1.6137, -3.3234,  1.7097},
                                  {4.3780, -4.2455, -0.1325}}};
// clang-format on

std::array<Expr, 3> through(const Pipeline& pipeline, std::array<Expr, 3> rgb) {
    for (const Stage& stage : pipeline)
        rgb = apply_stage(stage, rgb);
    return rgb;
}

std::array<Expr, 3> to_ictcp(const std::array<Expr, 3>& rgb) {
    return through(
        {MatrixStage{multiply(kXyzToLms, kRgbToXyz)},
         curve_stage(pq_encode_nits(100 * max(Expr::input(), 0))), MatrixStage{kLmsToIctcp}},
        rgb);
}

std::array<Expr, 3> to_rgb(const std::array<Expr, 3>& ictcp) {
    return through(
        {MatrixStage{inverse(kLmsToIctcp)}, curve_stage(pq_decode_nits(Expr::input()) / 100),
         MatrixStage{inverse(multiply(kXyzToLms, kRgbToXyz))}},
        ictcp);
}

CrossTalkStage frostbite_mapping(const Expr& linear_end) {
    const Expr rest = named("rest", 1 - linear_end);
    const auto compress = [&](const Expr& v) {
        const Expr above = named("above", max(v, linear_end) - linear_end);
        return named("compressed", select(less(v, linear_end), v,
                                          linear_end + rest * (1 - exp(-(above / rest)))));
    };

    // Chroma falls with intensity, so highlights fade to white before the compression.
    const std::array<Expr, 3> in = to_ictcp(compose({}));
    const Expr intensity = named("intensity", in[0]);
    const Expr saturation = named("saturation", pow(smoothstep(1, 0.3, intensity), 1.3));
    std::array<Expr, 3> c = to_rgb({intensity, named("faded_ct", saturation * named("ct", in[1])),
                                    named("faded_cp", saturation * named("cp", in[2]))});
    for (Expr& v : c)
        v = named("faded", v);

    const Expr largest = named("largest", max(max(c[0], c[1]), c[2]));
    const Expr ratio = named("ratio", select(less(largest, linear_end), 1,
                                             compress(largest) / max(largest, linear_end)));
    std::array<Expr, 3> compressed = c;
    for (Expr& v : compressed)
        v = named("mixed", mix(compress(v), v * ratio, 0.6));

    // Restores part of the chroma that the compression removed, unless the input was bright.
    const std::array<Expr, 3> m = to_ictcp(compressed);
    const Expr boost = named("boost", 0.3 * smoothstep(1, 0.5, intensity));
    const Expr dimmed = named("dimmed", m[0] / max(intensity, 1e-3));
    return {to_rgb({named("mixed_intensity", m[0]),
                    named("boosted_ct", mix(m[1], in[1] * dimmed, boost)),
                    named("boosted_cp", mix(m[2], in[2] * dimmed, boost))})};
}

}  // namespace

std::vector<Operator> define_frostbite() {
    Operator op;
    op.id = "frostbite";
    op.title = "Frostbite (hue preserving)";
    op.view = "Frostbite";
    op.character =
        "flat by design, a base for grading: keeps hues, highlights fade to white, shadows "
        "unchanged";
    op.source =
        "A. Fry, High Dynamic Range Color Grading and Display in Frostbite, GDC 2017; constants of "
        "T. Stachowiak's shadertoy";
    op.license = "published formula; none of its code is used";
    op.negatives = kNegativesClampAtZero;
    op.bounds = {.lut3d = 1.2e-2, .reason = "3D LUT: chroma falls to 0 within a stop about white"};
    op.parameters = {number_parameter("linear_end", "scene-linear", 0.25, 0.01, 0.99,
                                      "end of the linear segment of the compression")};
    op.build = [](const Params& p) -> Pipeline {
        return {limit_to_positive(), frostbite_mapping(p.expr("linear_end"))};
    };
    return {op};
}

TONEWRIGHT_NAMESPACE_END
