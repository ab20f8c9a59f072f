// SPDX-License-Identifier: Apache-2.0
#include "lut/half_value.h"

#include <limits>

TONEWRIGHT_NAMESPACE_BEGIN

double half_value(unsigned bits) noexcept {
    const unsigned exponent = bits >> 10 & 31;
    const unsigned mantissa = bits & 1023;
    double magnitude = 0;
    if (exponent == 31) {
        magnitude = mantissa ? std::numeric_limits<double>::quiet_NaN()
                             : std::numeric_limits<double>::infinity();
    } else if (exponent == 0) {
        magnitude = mantissa * 0x1p-24;
    } else {
        magnitude = (mantissa + 1024) * (static_cast<double>(1U << exponent) * 0x1p-25);
    }
    constexpr unsigned kSignBit = 0x8000;
    return bits & kSignBit ? -magnitude : magnitude;
}

TONEWRIGHT_NAMESPACE_END
