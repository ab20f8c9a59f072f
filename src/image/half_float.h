// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Half floats, as their 16 bits, that processors convert themselves: nearest, ties to even, beyond
/// the range infinity. Numbers follow each other in memory, which may have any alignment.
/// @returns  false, with nothing done, where the processor has no such instructions (before AVX2).
[[nodiscard]] bool half_to_float(const void* from, float* to, std::size_t count) noexcept;
[[nodiscard]] bool float_to_half(const float* from, void* to, std::size_t count) noexcept;

TONEWRIGHT_NAMESPACE_END
