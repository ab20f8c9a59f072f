// SPDX-License-Identifier: Apache-2.0
//
// Somewhat Boring Display Transform, Tomasz Stachowiak: an exponential on luminance for dull colors
// and on channels for colorful ones.
//
// Source    T. Stachowiak, "Somewhat boring display transform", in Bevy's tonemapping_shared.wgsl.
// In        scene-linear RGB, working primaries Rec.709, D65; domain [0, inf), negatives clamped at
//           0.
// Out       display-linear RGB, 1.0 = display peak; white at 0.97; saturated colors slightly above
//           1. Not clamped.
// Kind      3D. Monotone on the neutral axis: yes, 0.97 (1 - exp(-x)).
// Keeps     0 -> 0.
// Differs   nowhere.
// Check     mid gray 0.18 -> 0.159787895, (0.05, 0.1, 2) -> blue 1.003109218 (check_values.json).
#include "operators/family.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

CrossTalkStage boring_mapping() {
    const std::array<Expr, 3> c = {Expr::input(0), Expr::input(1), Expr::input(2)};
    const auto t = [](const Expr& v) { return 1 - exp(-v); };

    const Expr luma = named("luma", 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]);
    const Expr cb = named("cb", -0.1146 * c[0] - 0.3854 * c[1] + 0.5 * c[2]);
    const Expr cr = named("cr", 0.5 * c[0] - 0.4542 * c[1] - 0.0458 * c[2]);
    const Expr colorfulness = named("colorfulness", t(2.4 * sqrt(cb * cb + cr * cr)));
    const Expr excess = named("excess", max(0.8 * (colorfulness - 0.7), 0));
    const Expr desaturation = named("desaturation", excess * excess);
    const Expr ratio = named("ratio", t(luma) / max(luma, 1e-5));
    CrossTalkStage mapping{c};
    for (std::size_t i = 0; i < 3; ++i) {
        const Expr by_luma = named("by_luma", c[i] * ratio);
        const Expr by_channel = named("by_channel", t(mix(c[i], luma, desaturation)));
        mapping.f[i] = 0.97 * mix(by_luma, by_channel, colorfulness * colorfulness);
    }
    return mapping;
}

}  // namespace

std::vector<Operator> define_somewhat_boring() {
    Operator op;
    op.id = "somewhat_boring";
    op.title = "Somewhat Boring Display Transform";
    op.view = "Somewhat Boring";
    op.character =
        "keeps the hues of dull colors and bends those of bright highlights to white; soft, low "
        "contrast";
    op.source =
        "T. Stachowiak, Somewhat boring display transform, in Bevy: tonemapping_shared.wgsl";
    op.license = "MIT or Apache-2.0";
    op.negatives = kNegativesClampAtZero;
    op.bounds = {.lut3d = 1.4e-2,
                 .reason = "3D LUT: the slope jumps where the desaturation starts"};
    op.differences = {{DocumentedDifference::Kind::never_reaches_white, 0.97, ""}};
    op.build = [](const Params&) -> Pipeline { return {limit_to_positive(), boring_mapping()}; };
    return {op};
}

TONEWRIGHT_NAMESPACE_END
