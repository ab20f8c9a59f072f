// SPDX-License-Identifier: Apache-2.0
#pragma once

#if defined(TONEWRIGHT_HAVE_XBYAK) && defined(__x86_64__) && !defined(_WIN32)

#include <xbyak/xbyak.h>

#include <cstdint>
#include <vector>

#include "engine/simd_kernels.h"
#include "engine/vector_ir.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {

/// Allocates the registers of straight-line code while the code is written. If none is free, the
/// value that is needed latest is spilled to the stack (Belady).
class MachineRegisters : public Xbyak::CodeGenerator {
  protected:
    static constexpr std::int32_t kNone = VectorOperand::kNone;

    explicit MachineRegisters(const VectorMachine& machine)
        : CodeGenerator(Xbyak::DEFAULT_MAX_CODE_SIZE, Xbyak::AutoGrow), machine_(machine) {}

    void begin(const VectorCode& code);
    /// Keeps the constants that are read most in registers that the code does not need: short code
    /// waits for loads more than for arithmetic (Reinhard by luminance: 1.06 times as fast).
    void keep_constants(const VectorCode& code);

    // Operands. A register keeps its value until the instruction is written.
    Xbyak::Xmm in_register(const VectorOperand& operand, bool wide);
    Xbyak::Opmask mask(std::int32_t value);
    [[nodiscard]] bool is_in_memory(const VectorOperand& operand) {
        return operand.is_constant() ? kept_in(operand) == kNone : state(operand.value).reg < 0;
    }
    /// Address of an operand that is in memory, for the last operand of an instruction.
    Xbyak::Address in_memory(const VectorOperand& operand);
    /// True if nothing reads the operand's register after this instruction.
    [[nodiscard]] bool dies(const VectorOperand& operand);
    /// True if nothing reads the result of this instruction.
    [[nodiscard]] bool is_unread(const VectorInstruction& step) {
        return step.result != kNone && state(step.result).uses.empty();
    }

    // Results.
    /// A register without a value. It gets none until the instruction is written.
    int take() { return take(vectors_); }
    void lock(int reg) { vectors_.is_locked[static_cast<std::size_t>(reg)] = true; }
    /// Ends the uses of this instruction's operands. Values without further uses leave their
    /// registers.
    void release(const VectorInstruction& step);
    /// The register holds the value from now on.
    void define(std::int32_t value, int reg);
    /// A register for a result that is written after all operands are read. It may be that of an
    /// operand.
    Xbyak::Xmm result_after(const VectorInstruction& step);
    /// A register for a result that is written before all operands are read. It is not that of an
    /// operand.
    Xbyak::Xmm result_apart(const VectorInstruction& step);
    /// A register with the value of `from`: `from` itself, if no other instruction needs it, else a
    /// copy.
    Xbyak::Xmm result_over(const VectorInstruction& step, const VectorOperand& operand,
                           const Xbyak::Xmm& from);
    Xbyak::Opmask new_mask(const VectorInstruction& step);
    /// Frees the stack slots of values without further uses. Called after each instruction.
    void free_dropped_slots();

    [[nodiscard]] Xbyak::Xmm vector(int reg) const {
        return {machine_.has_avx512 ? Xbyak::Operand::ZMM : Xbyak::Operand::YMM, reg};
    }
    static Xbyak::Zmm zmm(const Xbyak::Xmm& r) { return Xbyak::Zmm(r.getIdx()); }

    VectorMachine machine_;
    std::size_t position_ = 0;  // index of the instruction that is being written
    int slot_count_ = 0;        // vectors on the stack

  private:
    /// Registers of one kind: vectors or masks.
    struct File {
        int first, end;  // registers that may hold values
        std::vector<std::int32_t> holder = std::vector(static_cast<std::size_t>(end), kNone);
        std::vector<bool> is_locked = std::vector<bool>(holder.size());
    };
    struct State {
        int reg = -1;
        bool is_mask = false;  // in a mask register
        int slot = -1;         // slot on the stack; -1: none
        std::vector<std::size_t> uses;
        std::size_t next = 0;  // index of the next use
    };

    State& state(std::int32_t value) { return state_[static_cast<std::size_t>(value)]; }
    File& file_of(const State& s) { return s.is_mask ? masks_ : vectors_; }
    [[nodiscard]] std::size_t next_use(std::int32_t value);
    int take(File& file);
    void unlock();
    void hold(std::int32_t value, int reg);
    void drop(std::int32_t value);
    int take_slot();
    Xbyak::Address slot_of(int slot) {
        return ptr[rsp + static_cast<std::size_t>(slot * machine_.bytes())];
    }
    /// The register that holds the constant, or kNone.
    [[nodiscard]] int kept_in(const VectorOperand& operand) const;
    Xbyak::Address constant(std::int32_t offset) {
        return ptr[rax + static_cast<std::size_t>(offset)];
    }
    void load_constant(const Xbyak::Xmm& r, std::int32_t offset, bool wide);

    File vectors_{}, masks_{};
    std::vector<State> state_;
    std::vector<std::int32_t> kept_;  // pool offsets of the constants in the last registers
    std::vector<int> free_slots_, dropped_slots_;
};

}  // namespace simd
TONEWRIGHT_NAMESPACE_END

#endif
