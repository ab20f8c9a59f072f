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

/// An instruction without registers: operands are indices of tape values.
struct Selected {
    ProgramOp op = ProgramOp::copy;
    std::uint32_t value = 0;  // the tape value that it defines
    std::array<std::int64_t, 4> operands = {kNone, kNone, kNone, kNone};
    std::array<double, 3> k{};
    const Table* table = nullptr;
    const Grid* grid = nullptr;
    const CompiledCurve* curve = nullptr;
    int channel = 0;  // channel of the grid
    int sibling = 0;  // number of siblings before it; siblings become one instruction
    bool wide = false;
    bool is_positive = false;
};

/// Selects as few instructions as possible for the values of a tape: fused multiply-adds, dot
/// products, clamps, comparisons within their selects.
/// @param in_double  values that are kept in double; select() adds those that are computed and read
///                   in double anyway
[[nodiscard]] std::vector<Selected> select(const FloatTape& tape, std::vector<bool>& in_double);

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
