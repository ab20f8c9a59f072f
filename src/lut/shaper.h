// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Entries of the 1D table before a 3D LUT: as many as readers accept, or the size to which they
/// resample a prelut.
inline constexpr int kShaperSteps = 65536;

/// The 1D table before a 3D LUT: codes at kShaperSteps equal scene-linear steps, from scene_lo to
/// scene_hi.
std::vector<float> shaper_table(const InputEncoding& encoding);

TONEWRIGHT_NAMESPACE_END
