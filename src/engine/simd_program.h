// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/simd_kernels.h"
#include "tonewright/engine.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {

/// The float program of a pipeline. The passes that change the last bits are here and only here:
///
/// 1. neighbouring matrices multiplied; division by a constant as multiplication by its reciprocal;
///    small whole powers as products;
/// 2. functions of one value compiled to piecewise polynomials, on instruction sets where that is
///    faster (curve_fitting.h);
/// 3. the values that float is too coarse for are kept in double (precision.h);
/// 4. products and sums contracted to fused multiply-adds and dot products, comparisons joined to
///    their selects;
/// 5. registers allocated, and the tile made as large as the first-level cache allows;
/// 6. for AVX2 and AVX-512, machine code of the same (machine_code.h).
/// @param has_curves  false leaves 2 out, to test the kernels that curves replace
[[nodiscard]] Code compile(const Pipeline& pipeline, double max_error = kSimdError,
                           const Target& target = find_target(), bool has_curves = true);

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
