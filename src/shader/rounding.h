// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "expr/interval.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Half a unit in the last place of 1 in float.
inline constexpr double kHalfUlp = 0x1p-24;
/// The smallest positive number that no processor flushes to 0.
inline constexpr double kSmallestFloat = 0x1p-126;

/// Errors of single operations, absolute.
struct Rounding {
    double once = 0;    // by half a unit in the last place
    double vulkan = 0;  // as the Vulkan specification allows it
};

/// Vulkan 1.3 specification, "Precision and Operation of SPIR-V Instructions", and WGSL (W3C,
/// 2024), 15.7.4.1 "Floating Point Accuracy", which takes the same bounds. For tables and Grids:
/// the operations on their samples, which are at most as large as the value.
/// @param value  largest value of the result
/// @param a, b   intervals of the operands
[[nodiscard]] Rounding rounding_of(ExprOp op, double value, const Interval& a, const Interval& b);

TONEWRIGHT_NAMESPACE_END
