// SPDX-License-Identifier: Apache-2.0
//
// Clamp: no tone mapping at all.
//
// Source    common practice; the first operator of every survey. apply=max: FFmpeg 5.1.9,
//           libavfilter, vf_tonemap.c, tonemap=clip with desat=0.
// In        scene-linear RGB, working primaries Rec.709, D65; domain (-inf, inf), negatives clamped
//           at 0.
// Out       display-linear RGB, 1.0 = display peak; range [0, 1].
// Kind      per channel, or max (parameter `apply`); monotone on the neutral axis: yes; inverse:
//           within [0, 1].
// Keeps     everything inside [0, 1].
// Differs   nowhere.
// Check     0.18 -> 0.18; (2, 1, 0.5) -> (1, 0.5, 0.25) (max).
#include "operators/family.h"

TONEWRIGHT_NAMESPACE_BEGIN

std::vector<Operator> define_clamp() {
    Operator op;
    op.id = "clamp";
    op.title = "Clamp";
    op.view = "Standard";
    op.character = "hard clip at 1: exact below, flat with shifted hues above";
    op.source = "common practice";
    op.license = "public domain";
    op.negatives = "clamped at 0";
    op.parameters = {
        choice_parameter("apply", {"channels", "max"}, "channels",
                         "channels: clips each channel; max: divides colors by their largest "
                         "channel if it exceeds 1, which keeps hue and saturation")};
    op.presets = {{"max", "clip of the largest channel", {{"apply", "max"}}}};
    op.build = [](const Params& p) -> Pipeline {
        if (p.choice("apply") == "channels") return {ClampStage{0, 1}};
        return {limit_to_positive(),
                ToneScaleStage{ToneScaleStage::Norm::max_rgb, {}, min(Expr::input(), 1)}};
    };
    return {op};
}

TONEWRIGHT_NAMESPACE_END
