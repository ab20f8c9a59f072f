// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

// Inverses that mix channels, as cubes over a display's light: OpenColorIO's own inversion of a
// forward cube is one of its codes, 48 nodes a side and sampled, and far from the inverse where the
// forward cube squeezes many colors into few.

/// Sampled from an exact inverse.
/// @param back  light of [0, peak] -> scene light
[[nodiscard]] Pipeline sampled_inverse(const Pipeline& back, double peak);

/// Fitted for the round trip. The same for the same chain.
/// @param forward    scene light -> light of [0, peak]
/// @param primaries  of the scene: nothing outside of them comes back.
[[nodiscard]] Pipeline fitted_inverse(const Pipeline& forward, const Primaries& primaries,
                                      double peak);

TONEWRIGHT_NAMESPACE_END
