// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/simd_kernels.h"
#include "tonewright/pipeline.h"

namespace tonewright::simd {

/// The float program of a pipeline. The passes that change the last bits are here and only here:
///
/// 1. neighbouring matrices multiplied; division by a constant as multiplication by its reciprocal;
///    small whole powers as products;
/// 2. the values that float is too coarse for are kept in double (precision.h);
/// 3. products and sums contracted to fused multiply-adds and dot products, comparisons joined to
///    their selects;
/// 4. registers allocated, and the tile made as large as the first-level cache allows.
[[nodiscard]] Code compile(const Pipeline& pipeline);

}  // namespace tonewright::simd
