// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/tone_curve.h"
#include "tonewright/pipeline.h"

/// Words that several operator files share. An operator file `<family>.cpp` defines
/// `std::vector<Operator> define_<family>()`; CMake puts the call into the registry.
namespace tonewright {

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

/// limit_to_positive(), then the curve as the parameters of with_apply() say.
inline Pipeline tone_curve_pipeline(const ToneCurve& curve, const Params& params) {
    return Pipeline{limit_to_positive()} + apply_tone_curve(curve, params);
}

}  // namespace tonewright
