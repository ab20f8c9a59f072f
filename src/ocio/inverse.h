// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ocio/lowered_op.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The inverse from a display's light, of the limit's primaries and [0, peak], to scene-linear in
/// the operator's working space. The first that there is of
///
/// - OpenColorIO's built-in transform, where the operator equals one;
/// - stage by stage: matrices inverted, and every run of curves and clamps that treats channels
///   apart as one table of its inverse, whose entries are at equal distances of light (a
///   half-domain table, inverted, has few of them next to white);
/// - where the operator is a cube: one that is sampled from the operator's own inverse, or fitted
///   for the round trip;
/// - every transform of the view inverted by OpenColorIO, with light limited to the last half float
///   below white, where only infinite light is white.
///
/// @return nothing where there is none of these: of a diagnostic view, in which many lights are
///         shown as one, and where OpenColorIO's inversion of the view needs nothing of ours.
[[nodiscard]] std::optional<LoweredOps> invert_light(const ResolvedOperator& op,
                                                     const DisplayLimit& limit);

TONEWRIGHT_NAMESPACE_END
