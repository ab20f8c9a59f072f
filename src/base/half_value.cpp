// SPDX-License-Identifier: Apache-2.0
#include "base/half_value.h"

#include <cmath>
#include <limits>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr unsigned kSignBit = 0x8000;

}  // namespace

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
    return bits & kSignBit ? -magnitude : magnitude;
}

unsigned half_bits(double value) noexcept {
    constexpr unsigned kInfinite = 0x7c00;
    constexpr double kSmallestNormal = 0x1p-14;
    const unsigned sign = std::signbit(value) ? kSignBit : 0;
    const double magnitude = std::fabs(value);
    if (std::isnan(value)) return sign | kInfinite | 512;
    if (magnitude >= 65520) return sign | kInfinite;
    // A mantissa that is rounded up to the next power of two carries into the exponent.
    if (magnitude < kSmallestNormal)
        return sign | static_cast<unsigned>(std::nearbyint(magnitude * 0x1p24));
    const int exponent = std::ilogb(magnitude);
    const auto mantissa =
        static_cast<unsigned>(std::nearbyint(std::ldexp(magnitude, 10 - exponent)));
    return sign | ((static_cast<unsigned>(exponent + 14) << 10) + mantissa);
}

TONEWRIGHT_NAMESPACE_END
