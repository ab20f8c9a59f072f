// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/program.h"
#include "engine/rewrite.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {

inline constexpr std::int64_t kNone = -1;

/// An instruction before it has registers: operands are indices of tape values.
struct Selected {
    Op op = Op::copy;
    std::uint32_t value = 0;  // the tape value that it defines
    std::array<std::int64_t, 4> operands = {kNone, kNone, kNone, kNone};
    std::array<double, 3> k{};
    const Table* table = nullptr;
    const Grid* grid = nullptr;
    const CompiledCurve* curve = nullptr;
    int channel = 0;  // of the grid
    int sibling = 0;  // 0, or how many siblings come before: they are one instruction
    bool wide = false;
    bool is_positive = false;
};

/// Instructions for the values of a tape, as few as possible: fused multiply-adds, dot products,
/// clamps, comparisons within their selects.
/// @param in_double  values that are kept in double; gains those that are computed and read in
///                   double anyway
[[nodiscard]] std::vector<Selected> select(const FloatTape& tape, std::vector<bool>& in_double);

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
