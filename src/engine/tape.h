// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "engine/compiled_curve.h"
#include "expr/scalar_ops.h"
#include "tonewright/engine.h"
#include "tonewright/expr.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// One step of a tape: its own index is the value it defines; a, b, c are earlier indices.
struct TapeInstruction {
    ExprOp op = ExprOp::constant;
    std::uint32_t a = 0, b = 0, c = 0;
    double value = 0;                      // of a constant; typical, of a uniform or an exposure
    double least = 0, most = 0;            // of a uniform: its range
    int input = 0;                         // of an input; channel of a grid
    bool is_limited = true;                // of an input: within +-kHalfMax. See limits_input()
    std::uint32_t source = 0;              // of a uniform: see simd::UniformPlace
    const Table* table = nullptr;          // of a lookup; owned by the tape
    const Grid* grid = nullptr;            // owned by the tape
    const CompiledCurve* curve = nullptr;  // of a lookup, instead of a table: see fit_curves()
    const ExprNode* node = nullptr;        // where it came from
};

/// The operands of the step, as many as its operation has.
[[nodiscard]] inline std::vector<std::uint32_t> operands_of(const TapeInstruction& step) {
    const std::array<std::uint32_t, 3> all = {step.a, step.b, step.c};
    return {all.begin(), all.begin() + operand_count(step.op)};
}

/// The same number for every pixel.
[[nodiscard]] constexpr bool is_number(ExprOp op) noexcept {
    return op == ExprOp::constant || op == ExprOp::uniform;
}

/// The steps that expose an input, up to i, the last first: its product with a number, or the
/// limits of such a product. Empty if i is something else.
[[nodiscard]] std::vector<std::uint32_t> exposure_steps(const std::vector<TapeInstruction>& code,
                                                        std::uint32_t i);
/// True if i is the limit of an input that engines do not limit: a number within +-kHalfMax.
[[nodiscard]] bool is_limited_exposure(const std::vector<TapeInstruction>& code, std::uint32_t i);

/// Expressions as straight-line code in single-assignment form: every node once, operands first.
/// No pass has touched it: running it in double is evaluate(), bit for bit.
class Tape {
  public:
    /// @param uniforms  those that the expressions may have
    /// @param limits_input  false: the expressions limit their inputs
    explicit Tape(const std::array<Expr, 3>& outputs, const LiveUniforms& uniforms = {},
                  bool limits_input = true);
    explicit Tape(const Pipeline& pipeline, const LiveUniforms& uniforms = {});

    [[nodiscard]] const std::vector<TapeInstruction>& code() const noexcept { return code_; }
    [[nodiscard]] const std::array<std::uint32_t, 3>& outputs() const noexcept { return outputs_; }

    /// Depends on no input: the same for every pixel.
    [[nodiscard]] bool is_number(std::uint32_t i) const { return is_number_[i]; }
    /// The instruction that is 1 divided by this one; no output reads it. There is one for every
    /// number that uniforms decide on and that others are divided by.
    [[nodiscard]] std::uint32_t reciprocal(std::uint32_t i) const { return reciprocal_.at(i); }
    /// Of every such instruction, with these uniforms; of all others 0.
    /// @throws Error  a uniform has no value, or one out of its range
    [[nodiscard]] std::vector<double> evaluate_numbers(const UniformValues& uniforms) const;

  private:
    std::uint32_t add(const Expr& expr, std::unordered_map<const ExprNode*, std::uint32_t>& seen);
    std::vector<TapeInstruction> code_;
    void push(const TapeInstruction& step, bool is_number, bool is_live);
    /// Inputs without limits get their typical exposure as their value.
    void note_exposures();
    std::vector<bool> is_number_;
    std::vector<bool> is_live_;  // a number that uniforms decide on
    std::unordered_map<std::uint32_t, std::uint32_t> reciprocal_;
    LiveUniforms uniforms_;
    bool limits_input_ = true;
    std::array<std::uint32_t, 3> outputs_{};
    std::vector<Expr> keep_;  // keeps nodes (and their tables) alive
};

/// For each value its register, so that values whose last use is over share one.
struct RegisterAllocation {
    std::vector<std::uint32_t> register_of;  // by value index
    std::uint32_t register_count = 0;
};
/// `operands(i)` of value i are live up to i; `pinned` values (the outputs) to the end.
/// An instruction's result may take the register of an operand that dies there: kernels read each
/// element before they write it.
[[nodiscard]] RegisterAllocation allocate_registers(
    const std::vector<std::array<std::int64_t, 4>>& operands,
    const std::vector<bool>& needs_register, const std::vector<std::uint32_t>& pinned);

TONEWRIGHT_NAMESPACE_END
