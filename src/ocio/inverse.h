// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "ocio/lowered_op.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The inverse from display-linear, in the primaries of the limit and [0, peak], to scene-linear in
/// the operator's working space. The first available one of
///
/// - OpenColorIO's built-in transform, if the operator equals one;
/// - stage by stage: inverts matrices, and turns every run of per-channel curves and clamps into a
///   table of its inverse, with entries at equal display-linear distances (an inverted half-domain
///   table has few entries near white);
/// - if the operator is a 3D LUT: a 3D LUT sampled from the operator's own inverse, or fitted for
///   the round trip;
/// - every transform of the view inverted by OpenColorIO. If only infinite values are white, the
///   input is limited to the last half float below white.
///
/// @param cache_folder  @see cached_numbers
/// @return nothing for a diagnostic view, which shows many colors as one, and if OpenColorIO
///         inverts the view without help.
[[nodiscard]] std::optional<LoweredOps> invert_light(const ResolvedOperator& op,
                                                     const DisplayLimit& limit,
                                                     const std::string& cache_folder = {});

TONEWRIGHT_NAMESPACE_END
