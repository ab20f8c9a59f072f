// SPDX-License-Identifier: Apache-2.0
//
// A new operator takes only this file, dropped into src/operators/. See new_operator.sh.
#include "operators/family.h"

TONEWRIGHT_NAMESPACE_BEGIN

std::vector<Operator> define_toy() {
    Operator op;
    op.id = "toy";
    op.title = "Toy";
    op.view = "Toy";
    op.character = "nothing to look at";
    op.source = "none";
    op.license = "Apache-2.0";
    op.negatives = kNegativesClampAtZero;
    op.parameters = with_apply(
        "channels", {number_parameter("knee", "scene-linear", 2, 0.1, 10, "half of white")});
    op.presets = {{"soft", "Toy, softer", {{"knee", "5"}}}};
    op.build = [](const Params& p) -> Pipeline {
        const Expr x = Expr::input();
        return tone_curve_pipeline({.f = x / (x + p.number("knee"))}, p);
    };
    return {op};
}

TONEWRIGHT_NAMESPACE_END
