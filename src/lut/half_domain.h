// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lut/half_value.h"
#include "tonewright/expr.h"

TONEWRIGHT_NAMESPACE_BEGIN

inline constexpr unsigned kHalfCount = 65536;
inline constexpr double kSmallestHalf = 0x1p-24;

/// 65536 samples of f at the half floats, in the order of their bit patterns; entry -0 equals +0,
/// NaN is f(0), infinities are f(+-65504). Outside [lo, hi] (by more than one half step) the value
/// at the end is held.
/// @param f       of input 0, finite on [lo, hi].
/// @param lo, hi  the interval that a clamp before the curve leaves.
[[nodiscard]] TONEWRIGHT_API std::vector<float> sample_half_domain(const Expr& f, double lo,
                                                                   double hi);

/// Of a table over half floats that is asked for nothing outside [lo, hi]: 0 for the entries that
/// are used, interpolated with or -0; 1 and -1 for the others, which may be larger or smaller: away
/// from the values inside, so that a table that rises still does.
[[nodiscard]] TONEWRIGHT_API std::vector<signed char> unused_entries(
    const std::vector<float>& table, double lo, double hi);

TONEWRIGHT_NAMESPACE_END
