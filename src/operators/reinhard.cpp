// SPDX-License-Identifier: Apache-2.0
//
// Reinhard's global operator, its form with a white point, and Jodie's blend.
//
// Source    E. Reinhard, M. Stark, P. Shirley, J. Ferwerda, "Photographic Tone Reproduction for
//           Digital Images", ACM Transactions on Graphics 21(3), SIGGRAPH 2002: equation 3
//           (reinhard) and equation 4 (reinhard_extended). "Reinhard-Jodie": Jodie, shadertoy
//           4dBcD1, 2017.
// In        scene-linear RGB, working primaries Rec.709, D65; domain [0, inf), negatives: clamped
// at
//           0 (f has a pole at -1).
// Out       display-linear RGB, 1.0 = display peak; reinhard [0, 1), reinhard_extended unbounded
//           above `white`, reinhard_jodie up to 1.002 for very saturated colours.
// Kind      per channel, luminance or max (parameter `apply`); jodie 3D. Monotone on the neutral
//           axis: yes; analytic inverse of the curves: yes.
// Keeps     f(0) = 0, f'(0) = 1; reinhard_extended: f(white) = 1.
// Differs   the paper scales by key/log-average first: here that is the exposure. Luminance forms
// are
//           0/0 at black in every source: here black stays black, the limit.
// Check     mid grey 0.18 -> 0.152542373 (0.154258475 with white 4) (python_check/operators.py).
#include "operators/family.h"

namespace tonewright {
namespace {

Operator simple() {
    Operator op;
    op.id = "reinhard";
    op.title = "Reinhard";
    op.view = "Reinhard";
    op.character = "soft everywhere, never reaches white; flat and grey with bright scenes";
    op.source =
        "Reinhard, Stark, Shirley, Ferwerda, Photographic Tone Reproduction for Digital Images, "
        "SIGGRAPH 2002, eq. 3";
    op.licence = "published formula";
    op.negatives = kNegativesClampAtZero;
    op.parameters = {apply_parameter("channels")};
    op.presets = {{"luminance", "Reinhard on luminance", {{"apply", "luminance"}}},
                  {"max", "Reinhard on the largest channel", {{"apply", "max"}}}};
    op.warnings = {
        "apply=luminance keeps chromaticity, so a saturated channel may exceed 1 and clip"};
    op.build = [](const Params& p) -> Pipeline {
        const Expr x = Expr::input();
        const Expr f = x / (1 + x);
        const Expr inverse = x / (1 - x);
        const std::string& apply = p.choice("apply");
        if (apply == "channels") return {limit_to_positive(), curve_stage(f, inverse)};
        return {limit_to_positive(), apply_curve(f, apply)};
    };
    return op;
}

Operator extended() {
    Operator op;
    op.id = "reinhard_extended";
    op.title = "Reinhard Extended";
    op.view = "Reinhard Extended";
    op.character = "Reinhard that reaches white at a scene value of your choice";
    op.source =
        "Reinhard, Stark, Shirley, Ferwerda, Photographic Tone Reproduction for Digital Images, "
        "SIGGRAPH 2002, eq. 4";
    op.licence = "published formula";
    op.negatives = kNegativesClampAtZero;
    op.parameters = {number_parameter("white", "scene-linear", 4, 0.01, 65504,
                                      "smallest scene value that is shown as display white"),
                     apply_parameter("channels")};
    op.presets = {{"luminance", "Reinhard Extended on luminance", {{"apply", "luminance"}}},
                  {"max", "Reinhard Extended on the largest channel", {{"apply", "max"}}}};
    op.warnings = {"above white the curve goes on past 1 with slope 1/white^2: displays clip it"};
    op.build = [](const Params& p) -> Pipeline {
        const Expr x = Expr::input();
        const double white = p.number("white");
        const Expr f = x * (1 + x / (white * white)) / (1 + x);
        return {limit_to_positive(), apply_curve(f, p.choice("apply"))};
    };
    return op;
}

Operator jodie() {
    Operator op;
    op.id = "reinhard_jodie";
    op.title = "Reinhard-Jodie";
    op.view = "Reinhard Jodie";
    op.character =
        "luminance Reinhard in the shadows, per channel in the lights: bright colours fade to "
        "white";
    op.source = "Jodie, shadertoy 4dBcD1, 2017: blend of eq. 3 on luminance and on channels";
    op.licence = "published formula";
    op.negatives = kNegativesClampAtZero;
    op.build = [](const Params&) -> Pipeline {
        const std::array<Expr, 3> c = {Expr::input(0), Expr::input(1), Expr::input(2)};
        const Expr luminance =
            kRec709Weights[0] * c[0] + kRec709Weights[1] * c[1] + kRec709Weights[2] * c[2];
        const auto channel = [&](const Expr& v) {
            const Expr t = v / (1 + v);
            return mix(v / (1 + luminance), t, t);
        };
        return {limit_to_positive(), Map3Stage{{channel(c[0]), channel(c[1]), channel(c[2])}}};
    };
    return op;
}

}  // namespace

std::vector<Operator> define_reinhard() { return {simple(), extended(), jodie()}; }

}  // namespace tonewright
