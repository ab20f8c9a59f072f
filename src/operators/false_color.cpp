// SPDX-License-Identifier: Apache-2.0
//
// False color: one color for every stop of luminance about mid gray. Shows exposure, not a picture.
//
// Source    Tonewright.
// In        scene-linear RGB, working primaries Rec.709, D65; domain [0, inf), negatives: clamped
//           at 0.
// Out       display-linear RGB, 1.0 = display peak; [0, 1].
// Kind      a matrix of three equal rows, then one curve for each channel; not monotone.
// Keeps     mid gray -> code value 0x80 of sRGB. Everything below -6.63 stops is black, everything
//           above +6.63 stops is white.
// Differs   nowhere.
// Check     mid gray 0.18 -> 0.215860500 (code value 128 of 255, decoded).
#include <cmath>

#include "operators/family.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// sRGB code values of the stops -7 and below, -6, ..., +6, +7 and above.
constexpr std::array<unsigned, 15> kColors = {0x000000, 0x16003B, 0x3B0A6B, 0x2A2A9E, 0x1F5FBF,
                                              0x1E97B5, 0x1FA36B, 0x808080, 0x7FB13A, 0xC9C22A,
                                              0xE8982A, 0xE2602C, 0xD62839, 0xF27BB5, 0xFFFFFF};
constexpr double kLowestStop = -7;
/// Half the width of a transition between two colors, in stops. It is wide enough that half-float
/// tables, with 1024 entries per stop, show every picture within a 16-bit step.
constexpr double kHalfWidth = 1.0 / 8;

double light(unsigned color, unsigned channel) {
    const unsigned code = color >> (16 - 8 * channel) & 0xFF;
    return srgb_decode(code / 255.0).value();
}

}  // namespace

std::vector<Operator> define_false_color() {
    Operator op;
    op.id = "false_color";
    op.title = "False color";
    op.view = "False Color";
    op.character =
        "one color per stop: gray at mid gray, blue to purple below, yellow to red above, white "
        "from 7 stops";
    op.source = "Tonewright";
    op.license = "Apache-2.0";
    op.negatives = kNegativesClampAtZero;
    op.is_diagnostic = true;
    op.differences = {{DocumentedDifference::Kind::crushes_black, 0.0018, ""},
                      {DocumentedDifference::Kind::not_monotone, 4.3, ""},
                      {DocumentedDifference::Kind::tints_gray, 0.75, ""}};
    op.bounds = {.ocio_cpu = 2e-5,
                 .ocio_gpu = 2e-5,
                 .reason = "one color blends into the next within a quarter of a stop"};
    op.build = [](const Params&) -> Pipeline {
        const Expr stops = named("stops", log2(Expr::input() / 0.18));
        CurveStage colors = curve_stage(0);
        for (unsigned channel = 0; channel < 3; ++channel) {
            Expr& f = colors.f[channel];
            f = light(kColors[0], channel);
            for (std::size_t i = 0; i + 1 < kColors.size(); ++i) {
                const double between = kLowestStop + static_cast<double>(i) + 0.5;
                const Expr weight =
                    named("weight", smoothstep(between - kHalfWidth, between + kHalfWidth, stops));
                f = f + (light(kColors[i + 1], channel) - light(kColors[i], channel)) * weight;
            }
        }
        // The colors are constant beyond seven stops. The limit of eight stops gives black a
        // logarithm.
        return {limit_to_positive(), MatrixStage{{kRec709Weights, kRec709Weights, kRec709Weights}},
                ClampStage{0.18 * std::exp2(-8), 0.18 * std::exp2(8)}, colors};
    };
    return {op};
}

TONEWRIGHT_NAMESPACE_END
