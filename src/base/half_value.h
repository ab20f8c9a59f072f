// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The half float of a bit pattern, as a double; NaN patterns give NaN.
[[nodiscard]] TONEWRIGHT_API double half_value(unsigned bits) noexcept;
/// The bit pattern of the nearest half float, ties to even; infinity from 65520 on.
[[nodiscard]] TONEWRIGHT_API unsigned half_bits(double value) noexcept;

TONEWRIGHT_NAMESPACE_END
