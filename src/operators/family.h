// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tonewright/pipeline.h"

/// Words that several operator files share. An operator file `<family>.cpp` defines
/// `std::vector<Operator> define_<family>()`; CMake puts the call into the registry.
namespace tonewright {

/// What nearly all operators do first: negatives of the working primaries are 0, and the half-float
/// range ends at 65504.
inline Stage limit_to_positive() { return ClampStage{0, kHalfMax}; }

inline constexpr const char* kNegativesClampAtZero =
    "clamped at 0 in the working primaries, before the first non-linear step";

/// The ways in which a pure tone curve meets colour (operators.md 2.2 and its sources).
inline ParameterSpec apply_parameter(std::string default_choice) {
    return choice_parameter("apply", {"channels", "luminance", "max"}, std::move(default_choice),
                            "how the curve meets colour: on each channel; or scaling all three by "
                            "f(n)/n, where n is the "
                            "relative luminance (0.2126, 0.7152, 0.0722) or the largest channel");
}

/// The curve (of input 0, f(0) = 0) applied as the parameter says.
inline Stage apply_curve(const Expr& f, const std::string& apply) {
    if (apply == "luminance")
        return ToneScaleStage{ToneScaleStage::Norm::luminance, kRec709Weights, f};
    if (apply == "max") return ToneScaleStage{ToneScaleStage::Norm::max_rgb, {}, f};
    return curve_stage(f);
}

}  // namespace tonewright
