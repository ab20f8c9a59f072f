// SPDX-License-Identifier: Apache-2.0
//
// A float program (program.h) as instructions over vectors (vector_ir.h).
#pragma once

#include <optional>

#include "engine/vector_ir.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {

/// The same for `blocks` blocks of pixels at a time, one instruction of each after the other: a
/// processor that waits for a result has the next block's instruction to begin with.
[[nodiscard]] VectorCode interleaved(const VectorCode& code, int blocks);

/// Nothing where more values go from part to part than a tile of 16 pixels has room for.
/// @param code  for a target with machine code; owns the tables that the result refers to
[[nodiscard]] std::optional<VectorProgram> translate(const Code& code);

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
