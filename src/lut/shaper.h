// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Entries of the 1D table before a 3D LUT: as many as readers accept, or resample a prelut to.
inline constexpr int kShaperSteps = 65536;

TONEWRIGHT_NAMESPACE_END
