// SPDX-License-Identifier: Apache-2.0
//
// Hable, John Hable 2010: the curve of Uncharted 2.
//
// Source    J. Hable, "Filmic Tonemapping Operators", filmicworlds.com, 2010-05-05, with the
// constants
//           of that page (A .15 ... W 11.2, exposure bias 2).
// In        scene-linear RGB, working primaries Rec.709, D65; domain [0, inf), negatives: clamped
// at 0. Out       display-linear RGB, 1.0 = display peak; range [0, 1.287) with the defaults. Kind
// per channel; monotone on the neutral axis: yes. Keeps     f(0) = 0; f(W / exposure_bias) = 1.
// Differs   nowhere. As on the page, the white W is not scaled by the bias: with the bias of 2,
// white
//           is reached at scene-linear 5.6. (Godot scales it; some ports put the bias on the
//           output.)
// Check     mid grey 0.18 -> 0.128338449 (python_check/operators.py).
#include "operators/family.h"

namespace tonewright {

std::vector<Operator> define_hable() {
    Operator op;
    op.id = "hable";
    op.title = "Hable (Uncharted 2)";
    op.view = "Hable";
    op.character = "strong toe, long soft shoulder: contrasty and dark, the game look of 2010";
    op.source = "J. Hable, Filmic Tonemapping Operators, filmicworlds.com, 2010";
    op.licence = "published formula (page: public domain code)";
    op.negatives = kNegativesClampAtZero;
    // D and F bounded away from 0: their product is the curve's denominator at black.
    op.parameters = {
        number_parameter("shoulder_strength", "", 0.15, 0.01, 1, "A of the formula"),
        number_parameter("linear_strength", "", 0.50, 0.01, 1, "B of the formula"),
        number_parameter("linear_angle", "", 0.10, 0, 1, "C of the formula"),
        number_parameter("toe_strength", "", 0.20, 0.01, 1, "D of the formula"),
        number_parameter("toe_numerator", "", 0.02, 0, 0.9, "E of the formula; below F"),
        number_parameter("toe_denominator", "", 0.30, 0.01, 1, "F of the formula"),
        number_parameter("white", "scene-linear, after the bias", 11.2, 0.1, 65504,
                         "W of the formula: biased scene value that is shown as display white"),
        number_parameter("exposure_bias", "", 2.0, 0.01, 100, "factor on the scene value"),
    };
    op.build = [](const Params& p) -> Pipeline {
        const double A = p.number("shoulder_strength");
        const double B = p.number("linear_strength");
        const double C = p.number("linear_angle");
        const double D = p.number("toe_strength");
        const double E = p.number("toe_numerator");
        const double F = p.number("toe_denominator");
        const auto h = [&](const Expr& x) {
            return (x * (A * x + C * B) + D * E) / (x * (A * x + B) + D * F) - E / F;
        };
        const double at_white = h(p.number("white")).value();
        if (!(at_white > 0)) {
            throw Error("hable: curve at white is " + shortest(at_white) +
                        "; expected above 0 (toe_numerator below toe_denominator, larger white)");
        }
        return {limit_to_positive(),
                curve_stage(h(p.number("exposure_bias") * Expr::input()) / at_white)};
    };
    return {op};
}

}  // namespace tonewright
