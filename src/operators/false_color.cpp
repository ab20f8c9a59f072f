// SPDX-License-Identifier: Apache-2.0
//
// False color: one color for every stop of luminance about mid gray. Shows exposure, not a picture.
//
// Source    Tonewright. palette=lygia: lygia 1.4.1, tonemapDebug, whose colors are those of
//           Filament's display range.
// In        scene-linear RGB, working primaries Rec.709, D65; domain [0, inf), negatives: clamped
//           at 0.
// Out       display-linear RGB, 1.0 = display peak; [0, 1].
// Kind      a matrix of three equal rows, then one curve for each channel; not monotone.
// Keeps     mid gray -> code value 0x80 of sRGB. Everything below -6.63 stops is black, everything
//           above +6.63 stops is white.
// Differs   nowhere.
//           palette=lygia: mid gray -> cyan; -5 stops and below black, +10 and above white.
// Check     mid gray 0.18 -> 0.215860500 (code value 128 of 255, decoded); (0, 0.9255, 0.9255)
//           (lygia).
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

/// Display-linear colors of lygia at the stops -5 and below, -4, ..., +10 and above, with straight
/// lines between them.
constexpr std::array<Vector3, 16> kLygiaColors = {{{0, 0, 0},
                                                   {0, 0, 0.1647},
                                                   {0, 0, 0.3647},
                                                   {0, 0, 0.6647},
                                                   {0, 0, 0.9647},
                                                   {0, 0.9255, 0.9255},
                                                   {0, 0.5647, 0},
                                                   {0, 0.7843, 0},
                                                   {1, 1, 0},
                                                   {0.90588, 0.75294, 0},
                                                   {1, 0.5647, 0},
                                                   {1, 0, 0},
                                                   {0.8392, 0, 0},
                                                   {1, 0, 1},
                                                   {0.6, 0.3333, 0.7882},
                                                   {1, 1, 1}}};

double light(unsigned color, unsigned channel) {
    const unsigned code = color >> (16 - 8 * channel) & 0xFF;
    return srgb_decode(code / 255.0).value();
}

/// Three equal rows, so that every channel becomes the luminance, in a range whose logarithm
/// exists.
Pipeline luminance_of(const Vector3& weights, double lowest_stop, double highest_stop) {
    return {limit_to_positive(), MatrixStage{{weights, weights, weights}},
            ClampStage{0.18 * std::exp2(lowest_stop), 0.18 * std::exp2(highest_stop)}};
}

Pipeline lygia() {
    const Expr v = named("v", log2(Expr::input() / 0.18) + 5);
    CurveStage colors = curve_stage(0);
    for (std::size_t channel = 0; channel < 3; ++channel) {
        Expr& f = colors.f[channel];
        f = kLygiaColors[0][channel];
        for (std::size_t i = 0; i + 1 < kLygiaColors.size(); ++i) {
            const Expr part = named("part", clamp(v - static_cast<double>(i), 0, 1));
            f = f + (kLygiaColors[i + 1][channel] - kLygiaColors[i][channel]) * part;
        }
    }
    return luminance_of(kLygiaWeights, -5, 10) + Pipeline{colors};
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
                      {DocumentedDifference::Kind::tints_gray, 0.75, ""},
                      {DocumentedDifference::Kind::crushes_black, 0.0056, "lygia"},
                      {DocumentedDifference::Kind::not_monotone, 92, "lygia"},
                      {DocumentedDifference::Kind::tints_gray, 1, "lygia"}};
    op.bounds = {.ocio_cpu = 4e-3,
                 .ocio_gpu = 4e-3,
                 .reason =
                     "palette=lygia: the slope jumps at every stop, between two half floats; "
                     "tonewright: 2e-5, one color blends into the next within a quarter of a "
                     "stop"};
    op.parameters = {choice_parameter("palette", {"tonewright", "lygia"}, "tonewright",
                                      "colors: Tonewright's, or those of lygia's tonemapDebug")};
    op.presets = {{"lygia", "tonemapDebug of lygia: cyan at mid gray", {{"palette", "lygia"}}}};
    op.build = [](const Params& p) -> Pipeline {
        if (p.choice("palette") == "lygia") return lygia();
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
        return luminance_of(kRec709Weights, -8, 8) + Pipeline{colors};
    };
    return {op};
}

TONEWRIGHT_NAMESPACE_END
