// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "base/half_value.h"
#include "tonewright/expr.h"

TONEWRIGHT_NAMESPACE_BEGIN

inline constexpr unsigned kHalfCount = 65536;
inline constexpr double kSmallestHalf = 0x1p-24;

/// 65536 samples of f at the half floats, in the order of their bit patterns; entry -0 equals +0,
/// NaN is f(0), infinities are f(+-65504). More than one half step outside [lo, hi] the end value
/// continues.
/// @param f       of input 0, finite on [lo, hi].
/// @param lo, hi  interval of the clamp before the curve.
[[nodiscard]] TONEWRIGHT_API std::vector<float> sample_half_domain(const Expr& f, double lo,
                                                                   double hi);

/// Slack of a half-float table without lookups outside [lo, hi]: 0 for entries that are used, for
/// their interpolation neighbors and for -0; 1 or -1 for the others, which may be larger or
/// smaller. The direction points away from the values inside, so a rising table still rises.
[[nodiscard]] TONEWRIGHT_API std::vector<signed char> unused_entries(
    const std::vector<float>& table, double lo, double hi);

TONEWRIGHT_NAMESPACE_END
