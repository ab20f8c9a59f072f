// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "tonewright/pipeline.h"

/// Application of a tone curve to color, shared by all operators with a tone curve.
TONEWRIGHT_NAMESPACE_BEGIN

struct ToneCurve {
    /// A function of input 0; defined for [0, kHalfMax].
    Expr f;
    /// Analytic inverse, if the source has one.
    std::optional<Expr> inverse = std::nullopt;
    /// 0: f is display-linear. Otherwise f is in code values of this power, and norms scale
    /// f^power.
    double code_power = 0;
    /// Weights of the luminance, in the operator's working primaries.
    Vector3 weights = kRec709Weights;
};

/// The operator's own parameters, followed by those of apply_tone_curve(): `apply` (`default_apply`
/// is the method of the source), `color_correction`, `saturation`, `saturation_from`.
[[nodiscard]] std::vector<ParameterSpec> with_apply(std::string default_apply,
                                                    std::vector<ParameterSpec> own = {});

/// Applies the curve as `params` choose. Input: limited to [0, kHalfMax].
///
/// channels: f of each channel. luminance, max: all channels times f(n)/n, where n is the luminance
/// or the largest channel; values of f below 0 become 0. hue_preserving: f of the largest and the
/// smallest channel; the middle one keeps its relative position.
///
/// Color corrections, with L the luminance and s the saturation (R. Mantiuk, R. Mantiuk,
/// A. Tomaszewska, W. Heidrich, "Color correction for tone mapping", Computer Graphics Forum 28(2),
/// Eurographics 2009): nonlinear (C/L)^s f(L), equation 2; luminance_preserving
/// ((C/L - 1) s + 1) f(L), equation 3. s may come from the curve's own contrast c = d ln f/d ln L
/// by the paper's fit s (1 + k1) c^k2/(1 + k1 c^k2), equation 5.
///
/// @throws Error  parameters that contradict each other; a norm with f(0) > 0, whose ratio f(n)/n
///                has no limit at black.
[[nodiscard]] Pipeline apply_tone_curve(const ToneCurve& curve, const Params& params);

TONEWRIGHT_NAMESPACE_END
