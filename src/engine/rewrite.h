// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "engine/curve_fitting.h"
#include "engine/tape.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {

/// A tape with cheaper operations. Products replace divisions by constants and small integer
/// powers, and compiled curves replace functions of one value. Equal constants are one value.
class FloatTape {
  public:
    explicit FloatTape(const Tape& tape);

    /// @param cache  owns the curves
    void fit_curves(const Sensitivity& sensitivity, CurveCache& cache, CurveForm form) {
        tonewright::fit_curves(code_, outputs_, sensitivity, cache, form);
    }

    [[nodiscard]] const std::vector<TapeInstruction>& code() const { return code_; }
    [[nodiscard]] const std::array<std::uint32_t, 3>& outputs() const { return outputs_; }

  private:
    std::uint32_t add(const TapeInstruction& step);
    [[nodiscard]] bool is_scale_of_positive(const TapeInstruction& select) const;
    std::uint32_t whole_power(std::uint32_t x, unsigned n);
    std::uint32_t constant(double value);
    std::uint32_t push(ExprOp op, std::uint32_t a, std::uint32_t b = 0) {
        code_.push_back({.op = op, .a = a, .b = b});
        return last();
    }

    [[nodiscard]] bool is_constant(std::uint32_t i) const {
        return code_[i].op == ExprOp::constant;
    }
    [[nodiscard]] std::uint32_t last() const {
        return static_cast<std::uint32_t>(code_.size() - 1);
    }

    std::vector<TapeInstruction> code_;
    std::array<std::uint32_t, 3> outputs_{};
    std::map<std::uint64_t, std::uint32_t> constants_;
};

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
