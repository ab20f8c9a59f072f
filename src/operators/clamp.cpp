// SPDX-License-Identifier: Apache-2.0
//
// Clamp: no tone mapping at all.
//
// Source    common practice; the first operator of every survey.
// In        scene-linear RGB, working primaries Rec.709, D65; domain (-inf, inf), negatives clamped
//           at 0.
// Out       display-linear RGB, 1.0 = display peak; range [0, 1].
// Kind      per channel; monotone on the neutral axis: yes; inverse: within [0, 1].
// Keeps     everything inside [0, 1].
// Differs   nowhere.
// Check     0.18 -> 0.18
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
    op.build = [](const Params&) -> Pipeline { return {ClampStage{0, 1}}; };
    return {op};
}

TONEWRIGHT_NAMESPACE_END
