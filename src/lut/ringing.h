// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Error bound of fit_rays() along the rays: less than kLargestRayError, because other colors lie
/// between the rays.
inline constexpr double kFittedRayError = 0.7 * kLargestRayError;

/// Which bounds a 3D LUT gets, and which nodes move.
struct RayFit {
    /// Each channel within kFittedRayError of the operator.
    bool has_band = true;
    /// Moves the nodes that photographs do not use.
    bool spares_photographs = false;
};

/// Makes the smallest changes to the nodes of a 3D LUT so that it follows the operator along rays
/// of rising exposure: falling only where the operator falls, and within the band. The rays are
/// dense: all hues and saturations of Rec.709, P3 and Rec.2020. Rays that cannot meet the bounds
/// keep the result of 128 rounds.
void fit_rays(Lut& lut, const LutRequest& request, bool trilinear, const RayFit& options);

TONEWRIGHT_NAMESPACE_END
