// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// 0..1, different everywhere, the same on every machine.
inline float noise(std::uint32_t i) {
    i = (i ^ 61U ^ (i >> 16U)) * 9U;
    i = (i ^ (i >> 4U)) * 0x27d4eb2dU;
    return static_cast<float>((i ^ (i >> 15U)) & 0xffffU) / 65535.0F;
}

TONEWRIGHT_NAMESPACE_END
