// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

// Channel-mixing inverses as 3D LUTs over display-linear. OpenColorIO's inversion of a 3D LUT
// samples 48 nodes a side over its codes, and is inaccurate where the 3D LUT compresses many colors
// into few.

/// Sampled from an exact inverse.
/// @param back  display-linear in [0, peak] -> scene-linear
[[nodiscard]] Pipeline sampled_inverse(const Pipeline& back, double peak);

/// Fitted for the round trip. Deterministic for a chain.
/// @param forward       scene-linear -> display-linear in [0, peak]
/// @param primaries     of the scene: the inverse does not reach colors outside them.
/// @param cache_folder  @see cached_numbers
[[nodiscard]] Pipeline fitted_inverse(const Pipeline& forward, const Primaries& primaries,
                                      double peak, const std::string& cache_folder);

TONEWRIGHT_NAMESPACE_END
