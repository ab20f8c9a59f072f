// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "pipeline/tone_curve.h"
#include "tonewright/pipeline.h"

/// Words that several operator files share. An operator file `<family>.cpp` defines
/// `std::vector<Operator> define_<family>()`; CMake puts the call into the registry.
TONEWRIGHT_NAMESPACE_BEGIN

/// What nearly all operators do first: negatives of the working primaries are 0, and the half-float
/// range ends at 65504.
inline Stage limit_to_positive() { return ClampStage{0, kHalfMax}; }

inline constexpr const char* kNegativesClampAtZero =
    "clamped at 0 in the working primaries, before the first non-linear step";

/// Weights of relative luminance of ITU-R BT.2020-2, table 4.
inline constexpr Vector3 kRec2020Weights = {0.2627, 0.6780, 0.0593};

/// One chain behind another.
inline Pipeline operator+(Pipeline a, const Pipeline& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

/// A condition on parameters that does not hold. Of live parameters that is not known.
inline bool fails(const Expr& condition) { return condition.is_constant(0); }

/// All channels times a number.
inline Stage scale_stage(const Expr& factor) {
    if (factor.is_constant()) return MatrixStage{scale(kIdentity3, factor.value())};
    return named("scale", curve_stage(factor * Expr::input()));
}

/// min(max(x, 0), hi) per channel.
inline Stage clamp_stage(const Expr& hi) {
    if (hi.is_constant()) return ClampStage{0, hi.value()};
    return named("limit", curve_stage(clamp(Expr::input(), 0, hi)));
}

/// A known defect: what `meant` is in `source`, the commit or page that the operator reproduces.
inline Operator defect_of(std::string meant, std::string id, std::string source,
                          std::string defect) {
    Operator op;
    op.id = std::move(id);
    op.source = std::move(source);
    op.licence = "formula and constants only; none of its code is used";
    op.negatives = kNegativesClampAtZero;
    op.defect = std::move(defect);
    op.meant = std::move(meant);
    return op;
}

/// ln(1 + x) for x >= 0. What 1 + x rounds away is missing in both parts of the quotient.
inline Expr log_of_1_plus(const Expr& x) {
    if (x.is_constant()) return std::log1p(x.value());
    const Expr u = 1 + x;
    return select(equal(u, 1), x, x * (log(u) / (u - 1)));
}

/// limit_to_positive(), then the curve as the parameters of with_apply() say.
inline Pipeline tone_curve_pipeline(const ToneCurve& curve, const Params& params) {
    return Pipeline{limit_to_positive()} + apply_tone_curve(curve, params);
}

/// Of an operator that makes pictures for SDR and HDR displays: "output", sdr or hdr.
inline ParameterSpec sdr_or_hdr_parameter(std::string help) {
    return display_parameter(
        choice_parameter("output", {"sdr", "hdr"}, "sdr", std::move(help)),
        [](const DisplayFacts& display) -> std::string { return display.is_hdr ? "hdr" : "sdr"; });
}

/// Of an operator that keeps its colors inside the primaries of a display: "limit", which of them
/// the display decides.
/// @param choices  of none, rec709, p3d65, rec2020
inline ParameterSpec limit_parameter(std::vector<std::string> choices, std::string value) {
    ParameterSpec spec = choice_parameter("limit", std::move(choices), std::move(value),
                                          "gamut that limits the colors");
    return display_parameter(std::move(spec), [](const DisplayFacts& display) -> std::string {
        if (display.primaries == kRec709) return "rec709";
        return display.primaries == kP3D65 ? "p3d65" : "rec2020";
    });
}

/// What the parameter "limit" says; `none` stands for none.
inline Primaries limiting_primaries(const Params& params, const Primaries& none) {
    const std::string& limit = params.choice("limit");
    if (limit == "none") return none;
    if (limit == "rec709") return kRec709;
    return limit == "p3d65" ? kP3D65 : kRec2020;
}

TONEWRIGHT_NAMESPACE_END
