// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "tonewright/pipeline.h"

/// How a pure tone curve meets color: one mechanism for every operator that has one.
TONEWRIGHT_NAMESPACE_BEGIN

struct ToneCurve {
    /// Of input 0; defined for [0, kHalfMax].
    Expr f;
    /// Analytic inverse, where the source has one.
    std::optional<Expr> inverse = std::nullopt;
    /// 0: f puts out light. Else code values of this power: norms then scale the light f^power.
    double code_power = 0;
    /// Of the luminance, in the operator's working primaries.
    Vector3 weights = kRec709Weights;
};

/// The operator's own parameters, and behind them what apply_tone_curve() reads: `apply`
/// (`default_apply` is how the source does it), `color_correction`, `saturation`,
/// `saturation_from`.
[[nodiscard]] std::vector<ParameterSpec> with_apply(std::string default_apply,
                                                    std::vector<ParameterSpec> own = {});

/// The curve as `params` want it applied. Input: limited to [0, kHalfMax].
///
/// channels: f of each. luminance, max: all three scaled by f(n)/n, n = luminance or the largest
/// channel; a curve that starts below 0 starts at 0 there. hue_preserving: f of the largest and the
/// smallest, the middle one keeps its place.
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
