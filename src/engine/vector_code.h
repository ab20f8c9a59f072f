// SPDX-License-Identifier: Apache-2.0
//
// Translation of a program (program.h) to instructions over vectors (vector_ir.h).
#pragma once

#include <optional>

#include "engine/vector_ir.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {

/// The code for `blocks` blocks of pixels at a time, with the instructions of the blocks in turns.
/// While one block waits for a result, the processor runs an instruction of the next.
[[nodiscard]] VectorCode interleaved(const VectorCode& code, int blocks);

/// @return  nullopt if the values that live between parts do not fit a tile of 16 pixels
/// @param program  for a target with machine code; owns the tables that the result refers to
[[nodiscard]] std::optional<VectorProgram> translate(const Program& program);

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
