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

/// One step of a tape. Its index is the value that it defines; a, b, c are indices of earlier
/// steps.
struct TapeInstruction {
    ExprOp op = ExprOp::constant;
    std::uint32_t a = 0, b = 0, c = 0;
    double value = 0;              // a constant, or the typical value of a uniform or an exposure
    double least = 0, most = 0;    // range of a uniform
    int input = 0;                 // channel of an input or a grid
    bool is_limited = true;        // false: an input without limits. See limits_input()
    std::uint32_t source = 0;      // source of a uniform: see simd::UniformPlace
    const Table* table = nullptr;  // table of a lookup, owned by the tape
    const Grid* grid = nullptr;    // owned by the tape
    const CompiledCurve* curve = nullptr;  // a lookup's curve instead of a table: see fit_curves()
    const ExprNode* node = nullptr;        // expression that the step computes
};

/// The operands of the step, as many as its operation has.
[[nodiscard]] inline std::vector<std::uint32_t> operands_of(const TapeInstruction& step) {
    const std::array<std::uint32_t, 3> all = {step.a, step.b, step.c};
    return {all.begin(), all.begin() + operand_count(step.op)};
}

/// True if the operation gives the same number for every pixel.
[[nodiscard]] constexpr bool is_number(ExprOp op) noexcept {
    return op == ExprOp::constant || op == ExprOp::uniform;
}

/// Steps that expose an input, up to i, the last one first: the product of the input and a number,
/// and the limits of that product. Empty if i is not such a step.
[[nodiscard]] std::vector<std::uint32_t> exposure_steps(const std::vector<TapeInstruction>& code,
                                                        std::uint32_t i);
/// True if i is an exposed input that is limited to numbers within +-kHalfMax.
[[nodiscard]] bool is_limited_exposure(const std::vector<TapeInstruction>& code, std::uint32_t i);

/// Expressions as straight-line code in single-assignment form: every node once, operands first. No
/// pass changes it, so running it in double gives the bits of evaluate().
class Tape {
  public:
    /// @param uniforms      uniforms that the expressions may have
    /// @param limits_input  false: the expressions limit their inputs
    explicit Tape(const std::array<Expr, 3>& outputs, const LiveUniforms& uniforms = {},
                  bool limits_input = true);
    explicit Tape(const Pipeline& pipeline, const LiveUniforms& uniforms = {});

    [[nodiscard]] const std::vector<TapeInstruction>& code() const noexcept { return code_; }
    [[nodiscard]] const std::array<std::uint32_t, 3>& outputs() const noexcept { return outputs_; }

    /// True if the value depends on no input, so that it is the same for every pixel.
    [[nodiscard]] bool is_number(std::uint32_t i) const { return is_number_[i]; }
    /// The instruction that computes 1 / value i. No output reads it. There is one for every number
    /// that depends on uniforms and divides another value.
    [[nodiscard]] std::uint32_t reciprocal(std::uint32_t i) const { return reciprocal_.at(i); }
    /// Values of all numbers (see is_number()) with these uniforms; 0 for all other values.
    /// @throws Error  a uniform has no value, or one out of its range
    [[nodiscard]] std::vector<double> evaluate_numbers(const UniformValues& uniforms) const;

  private:
    std::uint32_t add(const Expr& expr, std::unordered_map<const ExprNode*, std::uint32_t>& seen);
    std::vector<TapeInstruction> code_;
    void push(const TapeInstruction& step, bool is_number, bool is_live);
    /// Sets the value of inputs without limits to their typical exposure.
    void note_exposures();
    std::vector<bool> is_number_;
    std::vector<bool> is_live_;  // a number that depends on uniforms
    std::unordered_map<std::uint32_t, std::uint32_t> reciprocal_;
    LiveUniforms uniforms_;
    bool limits_input_ = true;
    std::array<std::uint32_t, 3> outputs_{};
    std::vector<Expr> keep_;  // keeps nodes (and their tables) alive
};

/// A register for each value. Values share a register if they do not live at the same time.
struct RegisterAllocation {
    std::vector<std::uint32_t> register_of;  // by value index
    std::uint32_t register_count = 0;
};
/// Allocates registers. The operands of value i live up to i, and `pinned` values (the outputs) to
/// the end. A result may take the register of an operand that dies there, because kernels read each
/// element before they write it.
[[nodiscard]] RegisterAllocation allocate_registers(
    const std::vector<std::array<std::int64_t, 4>>& operands,
    const std::vector<bool>& needs_register, const std::vector<std::uint32_t>& pinned);

TONEWRIGHT_NAMESPACE_END
