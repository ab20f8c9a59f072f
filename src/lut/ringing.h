// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// What fit_rays() brings the errors along the rays within: less than kLargestRayError, since other
/// colors lie between the rays.
inline constexpr double kFittedRayError = 0.7 * kLargestRayError;

/// Changes the nodes of a 3D LUT as little as it takes to follow the operator along rays of rising
/// exposure: each channel within kFittedRayError, and without falls that the operator does not
/// have. The rays are dense: all hues and saturations of Rec.709, P3 and Rec.2020. What cannot be
/// met stays as near as 128 rounds bring it.
void fit_rays(Lut& lut, const LutRequest& request, bool trilinear);

TONEWRIGHT_NAMESPACE_END
