// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "engine/tape.h"

namespace tonewright {

inline std::size_t operand_count(ExprOp op) {
    switch (op) {
        case ExprOp::constant:
        case ExprOp::input:
            return 0;
        case ExprOp::negate:
        case ExprOp::absolute:
        case ExprOp::square_root:
        case ExprOp::exp2:
        case ExprOp::log2:
        case ExprOp::sine:
        case ExprOp::cosine:
        case ExprOp::floor:
        case ExprOp::lookup:
            return 1;
        case ExprOp::select:
            return 3;
        default:
            return 2;
    }
}

/// The operands of an instruction, to be looped over.
class OperandRange {
  public:
    explicit OperandRange(const TapeInstruction& step)
        : values_{step.a, step.b, step.c}, count_(operand_count(step.op)) {}
    [[nodiscard]] const std::uint32_t* begin() const { return values_.data(); }
    [[nodiscard]] const std::uint32_t* end() const { return values_.data() + count_; }

  private:
    std::array<std::uint32_t, 3> values_;
    std::size_t count_;
};

inline OperandRange operands_of(const TapeInstruction& step) { return OperandRange(step); }

}  // namespace tonewright
