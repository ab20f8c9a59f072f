// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ocio/lower.h"
#include "tonewright/view.h"

namespace tonewright {

/// The way back from a display's light, of the limit's primaries and [0, peak], to scene-linear in
/// the operator's working space. The first that there is of
///
/// - OpenColorIO's built-in transform, where the operator equals one;
/// - stage by stage: matrices inverted, and every run of curves and clamps that treats channels
///   apart as one table of its inverse, whose entries are at equal distances of light (a
///   half-domain table, inverted, has few of them next to white);
/// - where the operator is a cube: one that is sampled from the operator's own inverse, or fitted
///   for the round trip.
///
/// @return null where there is none of these: what many lights are shown as one in (a diagnostic
///         view), and chains of tables and fixed functions that OpenColorIO inverts exactly.
[[nodiscard]] OCIO::GroupTransformRcPtr invert_light(const ResolvedOperator& op,
                                                     const DisplayLimit& limit);

}  // namespace tonewright
