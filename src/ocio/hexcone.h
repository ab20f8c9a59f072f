// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ocio/lowered_op.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A hexcone stage as HSV, half LUTs of logarithms with matrices that add one channel to the other,
/// and inverse HSV.
/// @param hi      largest value of a channel; the smallest is 0
/// @throws Error  if a channel would become negative, which HSV cannot represent, or if the tables
///                cannot be inverted.
[[nodiscard]] LoweredOps lower_hexcone(const HexconeStage& stage, double hi);

TONEWRIGHT_NAMESPACE_END
