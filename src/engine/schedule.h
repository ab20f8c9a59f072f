// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/vector_ir.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {

/// Puts instructions into an order in which a processor waits less (list scheduling). The results
/// have the same bits.
///
/// A program computes one long chain of dependent results after the other, and a processor looks
/// some 60 waiting instructions ahead (Zen 4). In the new order, the longest chain begins first,
/// and the others fill the time that it waits.
/// @param code  for one block
[[nodiscard]] VectorCode scheduled(const VectorCode& code);

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
