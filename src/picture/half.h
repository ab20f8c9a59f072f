// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>

#include "tonewright/version.h"

/// Half floats (IEEE 754 binary16) as bits, in all processors the same. Quiet and signaling NaN
/// keep their kind and the upper bits of their payload, as OpenEXR has it.
TONEWRIGHT_NAMESPACE_BEGIN

[[nodiscard]] inline float half_value(std::uint16_t half) {
    const std::uint32_t sign = (half & 0x8000U) << 16;
    const std::uint32_t exponent = half >> 10 & 0x1FU;
    const std::uint32_t fraction = half & 0x3FFU;
    if (exponent == 0) {  // zero or subnormal: a multiple of 2^-24
        const float size = static_cast<float>(fraction) * 0x1p-24F;
        return sign != 0 ? -size : size;
    }
    const std::uint32_t wide = exponent == 31 ? 255 : exponent + (127 - 15);
    return std::bit_cast<float>(sign | wide << 23 | fraction << 13);
}

/// The nearest half float, ties to even; beyond the range infinity.
[[nodiscard]] inline std::uint16_t nearest_half(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    const auto sign = static_cast<std::uint16_t>(bits >> 16 & 0x8000U);
    const std::uint32_t size = bits & 0x7FFFFFFFU;
    const auto with_sign = [&](std::uint32_t half) {
        return static_cast<std::uint16_t>(sign | half);
    };
    if (size > 0x7F800000U) {
        const std::uint32_t payload = size >> 13 & 0x3FFU;
        return with_sign(0x7C00U | (payload != 0 ? payload : 1U));
    }
    if (size >= 0x477FF000U) return with_sign(0x7C00U);  // 65520, halfway to 2^16
    if (size < 0x38800000U) {                            // 2^-14: subnormal results
        // The sum's last bit is 2^-24, and the addition rounds to it.
        const float sum = std::bit_cast<float>(size) + 0.5F;
        return with_sign(std::bit_cast<std::uint32_t>(sum) - std::bit_cast<std::uint32_t>(0.5F));
    }
    const std::uint32_t odd = size >> 13 & 1U;
    return with_sign((size - ((127U - 15U) << 23) + 0xFFFU + odd) >> 13);
}

TONEWRIGHT_NAMESPACE_END
