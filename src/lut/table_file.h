// SPDX-License-Identifier: Apache-2.0
//
// LUT files as stages of operators.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/definition.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The text of the largest 3D LUT of 129 nodes a side has some 80 million characters.
inline constexpr std::size_t kLargestLutFile = std::size_t{128} << 20U;

/// A 3D LUT over [0, 1].
/// @param nodes  RGB triplets, red fastest
/// @throws Error  more than 129 nodes a side, which no reader supports
[[nodiscard]] TONEWRIGHT_API GridStage grid_of(int edge, const std::vector<float>& nodes);
/// A 1D table of each channel over [0, 1], linear between its entries.
/// @param rows  RGB triplets
[[nodiscard]] TONEWRIGHT_API CurveStage tables_of(const std::vector<float>& rows);
/// The same with entries at all half floats, in the order of their bit patterns.
[[nodiscard]] TONEWRIGHT_API CurveStage half_tables_of(const std::vector<float>& rows);
/// Maps [lo, hi] of each channel to [0, 1]; nothing if that changes nothing.
TONEWRIGHT_API void add_range(Pipeline& stages, const Vector3& lo, const Vector3& hi);

/// Description of the stages, and the input and output stated in files of Tonewright.
/// @param contents  of the file; the beginning is enough except for ICC profiles
TONEWRIGHT_API void describe_table(TableFile& table, const std::string& path,
                                   std::string_view contents);

TONEWRIGHT_NAMESPACE_END
