// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "engine/select.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {

/// Index in Program::curves of each curve that the tape refers to.
using CurveIndex = std::map<const CompiledCurve*, std::uint32_t>;

/// Makes the program for a target, without machine code: allocates registers, makes the tile as
/// large as the first-level cache allows, and collects constants, tables, grids and curves.
/// @param curve_index  set unless null
[[nodiscard]] Program assemble(const FloatTape& tape, const std::vector<bool>& in_double,
                               const std::vector<Selected>& selected, const Target& target,
                               CurveIndex* curve_index);

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
