// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tonewright/pipeline.h"

namespace tonewright {

/// An inverse that mixes channels, as a cube over a display's light that is sampled from it:
/// OpenColorIO's own inversion of a forward cube is one of its codes, 48 nodes a side, and far from
/// the inverse where the forward cube squeezes many colours into few.
/// @param back  light of [0, peak] -> scene light
[[nodiscard]] Pipeline sampled_inverse(const Pipeline& back, double peak);

}  // namespace tonewright
