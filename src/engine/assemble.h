// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "engine/select.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {

/// Where a code has the curves that its tape refers to.
using CurveIndex = std::map<const CompiledCurve*, std::uint32_t>;

/// The program for a target, without machine code: gives values their registers, makes the tile as
/// large as the first-level cache allows, and collects constants, tables, grids and curves.
/// @param curve_index  set unless null
[[nodiscard]] Code assemble(const FloatTape& tape, const std::vector<bool>& in_double,
                            const std::vector<Selected>& selected, const Target& target,
                            CurveIndex* curve_index);

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
