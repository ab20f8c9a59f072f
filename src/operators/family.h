// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "pipeline/tone_curve.h"
#include "tonewright/pipeline.h"

/// Functions that operator files share. An operator file `<family>.cpp` defines
/// `std::vector<Operator> define_<family>()`; CMake adds the call to the registry.
TONEWRIGHT_NAMESPACE_BEGIN

/// First stage of nearly all operators: clamps channels in the working primaries to [0, 65504], the
/// half-float range.
inline Stage limit_to_positive() { return ClampStage{0, kHalfMax}; }

inline constexpr const char* kNegativesClampAtZero =
    "clamped at 0 in the working primaries, before the first non-linear step";

/// Weights of relative luminance of ITU-R BT.2020-2, table 4.
inline constexpr Vector3 kRec2020Weights = {0.2627, 0.6780, 0.0593};

/// Weights of gray in the Tonemap classes of OpenCV 4.6.0, which take the first channel of a
/// picture for red, although it is blue.
inline constexpr Vector3 kOpencvWeights = {0.114, 0.587, 0.299};

/// Weights of luminance in lygia 1.4.1.
inline constexpr Vector3 kLygiaWeights = {0.21250175, 0.71537574, 0.07212251};

/// Concatenates two chains.
inline Pipeline operator+(Pipeline a, const Pipeline& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

/// True if a condition on parameters is known to be false. With live parameters it is not known.
inline bool fails(const Expr& condition) { return condition.is_constant(0); }

/// Scales all channels.
inline Stage scale_stage(const Expr& factor) {
    if (factor.is_constant()) return MatrixStage{scale(kIdentity3, factor.value())};
    return named("scale", curve_stage(factor * Expr::input()));
}

/// min(max(x, 0), hi) per channel.
inline Stage clamp_stage(const Expr& hi) {
    if (hi.is_constant()) return ClampStage{0, hi.value()};
    return named("limit", curve_stage(clamp(Expr::input(), 0, hi)));
}

/// A known defect: the operator `meant` as implemented in `source`, the commit or page that this
/// operator reproduces.
inline Operator defect_of(std::string meant, std::string id, std::string source,
                          std::string defect) {
    Operator op;
    op.id = std::move(id);
    op.source = std::move(source);
    op.license = "formula and constants only; none of its code is used";
    op.negatives = kNegativesClampAtZero;
    op.defect = std::move(defect);
    op.meant = std::move(meant);
    return op;
}

/// ln(1 + x) for x >= 0. The rounding error of 1 + x cancels in the quotient.
inline Expr log_of_1_plus(const Expr& x) {
    if (x.is_constant()) return std::log1p(x.value());
    const Expr u = 1 + x;
    return select(equal(u, 1), x, x * (log(u) / (u - 1)));
}

/// limit_to_positive(), then the curve, applied as the parameters of with_apply() choose.
inline Pipeline tone_curve_pipeline(const ToneCurve& curve, const Params& params) {
    return Pipeline{limit_to_positive()} + apply_tone_curve(curve, params);
}

/// Parameter "output" (sdr or hdr) of operators for SDR and HDR displays.
inline ParameterSpec sdr_or_hdr_parameter(std::string help) {
    return display_parameter(
        choice_parameter("output", {"sdr", "hdr"}, "sdr", std::move(help)),
        [](const DisplayFacts& display) -> std::string { return display.is_hdr ? "hdr" : "sdr"; });
}

/// Parameters "minimum" and "maximum" of operators that stretch the range of the picture.
inline ParameterSpec smallest_channel_parameter() {
    return number_parameter("minimum", "scene-linear", 0, 0, kHalfMax,
                            "smallest channel of the picture, shown as black");
}
inline ParameterSpec largest_channel_parameter() {
    return statistic_parameter(
        number_parameter("maximum", "scene-linear", 1, 1e-6, kHalfMax,
                         "largest channel of the picture"),
        "largest channel", [](const SceneStatistics& s) {
            return std::max({s.maximum_rgb[0], s.maximum_rgb[1], s.maximum_rgb[2]});
        });
}

/// Parameter "limit" of operators that limit colors to the gamut of a display. The display chooses
/// its default.
/// @param choices  a subset of none, rec709, p3d65, rec2020
inline ParameterSpec limit_parameter(std::vector<std::string> choices, std::string value) {
    ParameterSpec spec = choice_parameter("limit", std::move(choices), std::move(value),
                                          "gamut that limits the colors");
    return display_parameter(std::move(spec), [](const DisplayFacts& display) -> std::string {
        if (display.primaries == kRec709) return "rec709";
        return display.primaries == kP3D65 ? "p3d65" : "rec2020";
    });
}

/// Primaries of the parameter "limit"; `none` for the choice none.
inline Primaries limiting_primaries(const Params& params, const Primaries& none) {
    const std::string& limit = params.choice("limit");
    if (limit == "none") return none;
    if (limit == "rec709") return kRec709;
    return limit == "p3d65" ? kP3D65 : kRec2020;
}

TONEWRIGHT_NAMESPACE_END
