// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>

#include "engine/vector_ir.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {

/// Machine code of a program for this processor. Values stay in registers, where the interpreter
/// writes each to the first-level cache and reads it back. Both compute the same bits.
class MachineCode {
  public:
    /// Null if the system gives no executable memory, the build has no assembler, or more values
    /// are alive between the program's parts than a tile holds. Then the interpreter runs, which is
    /// slower.
    /// @pre the program's target has machine code
    /// @param program  gets the pool of numbers that the machine code reads
    [[nodiscard]] static std::shared_ptr<const MachineCode> make(Program& program);

    /// False if the build has no assembler.
    [[nodiscard]] static bool is_built_in() noexcept;

    MachineCode(const MachineCode&) = delete;
    MachineCode& operator=(const MachineCode&) = delete;
    virtual ~MachineCode() = default;

    [[nodiscard]] const VectorProgram& program() const noexcept { return program_; }
    [[nodiscard]] std::size_t part_count(PixelLayout layout) const noexcept {
        return bytes_[static_cast<std::size_t>(layout)].size();
    }
    /// Size of a part's machine code.
    [[nodiscard]] std::size_t bytes(std::size_t part, PixelLayout layout) const noexcept {
        return bytes_[static_cast<std::size_t>(layout)][part];
    }

    /// Runs one part over blocks. A block has one pixel for each lane of the target's vectors.
    /// @param tile     values that parts hand on to other parts
    /// @param in, out  pixels, for the parts that read or write them; may be the same
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
    std::array<std::vector<Function>, 2> function_;  // [layout][part]
    std::array<std::vector<std::size_t>, 2> bytes_;
};

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
