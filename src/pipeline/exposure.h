// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The source's numbers as exposed light in its own primaries: decoding, the factor, and then the
/// limit of half floats, so that a sun of 300,000 at -17 stops keeps its color. Linear light at
/// factor 1 has no stages, because engines limit what they read.
///
/// @param decode  of the source; empty: linear
/// @param factor  exposure, as a number or of a uniform
[[nodiscard]] TONEWRIGHT_API Pipeline exposed_stages(const Pipeline& decode, const Expr& factor);

TONEWRIGHT_NAMESPACE_END
