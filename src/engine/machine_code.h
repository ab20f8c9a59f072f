// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>

#include "engine/vector_ir.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {

/// A float program as code of the processor that runs now: values stay in registers, where the
/// interpreter writes each to the first-level cache and reads it back. Computes the same bits.
class MachineCode {
  public:
    /// Nothing where the system gives no memory that can be executed, the build has no assembler,
    /// or the program has more values between its parts than a tile holds: then the interpreter
    /// runs, slower.
    /// @pre the code's target has machine code
    /// @param code  gets the numbers that it reads
    [[nodiscard]] static std::shared_ptr<const MachineCode> make(Code& code);

    /// False where the build had no assembler.
    [[nodiscard]] static bool is_built_in() noexcept;

    MachineCode(const MachineCode&) = delete;
    MachineCode& operator=(const MachineCode&) = delete;
    virtual ~MachineCode() = default;

    [[nodiscard]] const VectorProgram& program() const noexcept { return program_; }
    [[nodiscard]] std::size_t part_count(PixelLayout layout) const noexcept {
        return bytes_[static_cast<std::size_t>(layout)].size();
    }
    /// Of code.
    [[nodiscard]] std::size_t bytes(std::size_t part, PixelLayout layout) const noexcept {
        return bytes_[static_cast<std::size_t>(layout)][part];
    }

    /// Runs one part over blocks of as many pixels as the target's vectors have lanes.
    /// @param tile     values that come from other parts or go there
    /// @param in, out  of the parts that read or write pixels. May be the same.
    void run(std::size_t part, PixelLayout layout, const Numbers& numbers, unsigned char* tile,
             const float* in, float* out, std::size_t blocks) const noexcept {
        function_[static_cast<std::size_t>(layout)][part](tile, in, out, blocks,
                                                          numbers.pool.data());
    }

  protected:
    explicit MachineCode(VectorProgram program) : program_(std::move(program)) {}

    using Function = void (*)(unsigned char*, const float*, float*, std::size_t,
                              const ConstantVector* pool);
    VectorProgram program_;
    std::array<std::vector<Function>, 2> function_;  // by layout, by part
    std::array<std::vector<std::size_t>, 2> bytes_;
};

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
