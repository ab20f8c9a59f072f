// SPDX-License-Identifier: Apache-2.0
//
// Khronos PBR Neutral: keeps the base colors of materials, compresses highlights and fades them to
// white; and the variants of Filament and Needle Engine.
//
// Source    Khronos Group, "Khronos PBR Neutral Tone Mapper", 2024: KhronosGroup/ToneMapping,
//           PBR_Neutral, pbrNeutral.glsl. Google Filament, ToneMapper.cpp, PBRNeutralToneMapper.
//           Needle Engine, @needle-tools/engine 4.16.5, engine_tonemapping.ts: model-viewer's first
//           commerce tone mapper (github.com/google/model-viewer/pull/4495).
// In        scene-linear RGB, working primaries Rec.709, D65; domain [0, inf), negatives clamped at
//           0 (the toe's parabola would lower them further).
// Out       display-linear RGB, 1.0 = display peak; range [0, 1).
// Kind      khronos_neutral_needle: 3D, because its mix towards 1 depends on the sum of the
//           channels. The others: 3D, of the largest and the smallest channel: a hexcone stage.
//           With x = min, p = max - offset(x), Ks = start_compression - 0.04 and d = 1 - Ks, the
//           source subtracts the offset from every channel and returns c = p - (max - in) below Ks.
//           Above it computes n = 1 - d^2/(p + d - Ks), scales c by n/p and mixes towards n with
//           the weight g = 1 - 1/(desaturation (p - n) + 1):
//             n/p (p - (max - in)) (1 - g) + g n = n - (1 - g) n/p (max - in).
//           So value(p) is p, then n; chroma(p) is 1, then (1 - g) n/p. Filament mixes towards 1:
//           its value(p) is (1 - g) n + g. Both have a continuous slope at Ks. Monotone on the
//           neutral axis: yes; invertible.
// Keeps     0 -> 0; the hue of HSV; colors whose smallest channel is at least 0.08 are lowered by
//           0.04, up to Ks.
// Differs   nowhere. The constants 0.04 and 6.25 (a Fresnel reflectance F90 of 0.04, and 1/(4 F90))
//           do not change with start_compression.
// Check     mid gray 0.18 -> 0.14, 1 -> 0.869090909 (check_values.json).
#include "operators/family.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::vector<ParameterSpec> neutral_parameters() {
    return {
        number_parameter("start_compression", "scene-linear", 0.8, 0.1, 0.99,
                         "scene value of a gray above which highlights are compressed"),
        number_parameter("desaturation", "", 0.15, 0, 1,
                         "how fast compressed highlights fade to white"),
    };
}

/// @param towards_white  mix towards 1 instead of the compressed peak.
Pipeline neutral(const Params& params, bool towards_white) {
    const Expr start = named("start", params.expr("start_compression") - 0.04);
    const Expr d = named("d", 1 - start);
    const Expr x = Expr::input();
    // q is constant below the start, so no division by 0 occurs there.
    const Expr q = named("peak", max(x, start));
    const Expr n = named("n", 1 - d * d / (q + d - start));
    const Expr rest =
        named("one_minus_g", 1 / (params.expr("desaturation") * (q - n) + 1));  // 1 - g
    const Expr is_base = named("is_base", less(x, start));
    return {limit_to_positive(),
            HexconeStage{.offset = select(less(x, 0.08), x - 6.25 * x * x, 0.04),
                         .value = select(is_base, x, towards_white ? rest * n + (1 - rest) : n),
                         .chroma = select(is_base, 1, rest * (n / q))}};
}

/// Inverse: the largest channel from value(p), the others from chroma(p), then the offset from the
/// smallest: 6.25 x^2 = m below 0.04.
Pipeline neutral_inverse(const Params& params) {
    const Expr start = named("start", params.expr("start_compression") - 0.04);
    const Expr d = named("d", 1 - start);
    const Expr x = Expr::input();
    const Expr n = named("n", max(x, start));
    // White is infinite in the scene: use the largest half float.
    const Expr p = named("p", d * d / max(1 - n, d * d / 65504) - d + start);
    const Expr is_base = named("is_base", less(x, start));
    const Expr to_light = named("to_light", (params.expr("desaturation") * (p - n) + 1) * (p / n));
    return {limit_to_positive(),
            HexconeStage{.offset = Expr(0),
                         .value = select(is_base, x, p),
                         .chroma = select(is_base, 1, to_light)},
            // Colors that the operator never produces may have a channel below 0 here.
            HexconeStage{.offset = select(less(x, 0.04), x - sqrt(max(x, 0) / 6.25), -0.04),
                         .value = x,
                         .chroma = Expr(1)}};
}

Operator khronos() {
    Operator op;
    op.id = "khronos_neutral";
    op.title = "Khronos PBR Neutral";
    op.view = "Khronos PBR Neutral";
    op.character =
        "product colors match their materials, minus a reflection of 0.04; compresses only "
        "highlights, which fade to white";
    op.source = "Khronos Group, Khronos PBR Neutral Tone Mapper, 2024: pbrNeutral.glsl";
    op.license = "Apache-2.0 (code), CC-BY-4.0 (text)";
    op.dialects = "PBR Neutral";
    op.negatives = kNegativesClampAtZero;
    op.parameters = neutral_parameters();
    op.build = [](const Params& p) { return neutral(p, false); };
    op.build_inverse = neutral_inverse;
    return op;
}

Operator filament() {
    Operator op;
    op.id = "khronos_neutral_filament";
    op.title = "PBR Neutral (Filament)";
    op.view = "PBR Neutral Filament";
    op.character =
        "Khronos PBR Neutral with highlights mixed towards 1: brighter above the start of the "
        "compression";
    op.source = "Google Filament, ToneMapper.cpp: PBRNeutralToneMapper";
    op.license = "Apache-2.0; formula and constants only; none of its code is used";
    op.dialects = "PBR Neutral";
    op.negatives = kNegativesClampAtZero;
    op.parameters = neutral_parameters();
    op.build = [](const Params& p) { return neutral(p, true); };
    return op;
}

Operator needle() {
    Operator op;
    op.id = "khronos_neutral_needle";
    op.title = "PBR Neutral (Needle Engine)";
    op.view = "PBR Neutral Needle";
    op.character =
        "forerunner of Khronos PBR Neutral: no reflection is subtracted, bright colors fade to "
        "white by the light of all channels";
    op.source =
        "Needle Engine, @needle-tools/engine 4.16.5, engine_tonemapping.ts: patchNeutral; after "
        "model-viewer";
    op.license = "formula and constants only; none of its code is used";
    op.dialects = "PBR Neutral";
    op.negatives = kNegativesClampAtZero;
    op.bounds = {.lut3d = 0.12,
                 .reason =
                     "the slope jumps where the largest channel passes 0.8, and no node of a "
                     "3D LUT is there"};
    op.build = [](const Params&) -> Pipeline {
        constexpr double kStart = 0.8;
        constexpr double kRange = 1 - kStart;
        constexpr double kDesaturation = 0.5;
        const std::array<Expr, 3> c = {Expr::input(0), Expr::input(1), Expr::input(2)};
        const Expr largest = named("largest", max(max(c[0], c[1]), c[2]));
        const Expr peak = named("peak", max(largest, kStart));
        const Expr new_peak = named("new_peak", 1 - kRange * kRange / (peak + kRange - kStart));
        const Expr extra = named("extra_brightness", (c[0] + c[1] + c[2]) * (1 - kStart / peak));
        const Expr kept = named("kept", 3 / (kDesaturation * extra + 3));
        CrossTalkStage stage{c};
        for (Expr& channel : stage.f) {
            channel = select(less(largest, kStart), channel,
                             channel * (new_peak / peak) * kept + (1 - kept));
        }
        return {limit_to_positive(), stage};
    };
    return op;
}

}  // namespace

std::vector<Operator> define_khronos_neutral() { return {khronos(), filament(), needle()}; }

TONEWRIGHT_NAMESPACE_END
