// SPDX-License-Identifier: Apache-2.0
#include "picture/half.h"

#include <Imath/half.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <random>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(Half, ValuesAreThoseOfImath) {
    for (std::uint32_t bits = 0; bits < 0x10000; ++bits) {
        const auto half = static_cast<std::uint16_t>(bits);
        const float expected = imath_half_to_float(half);
        ASSERT_EQ(std::bit_cast<std::uint32_t>(half_value(half)),
                  std::bit_cast<std::uint32_t>(expected))
            << bits;
    }
}

TEST(Half, NearestIsThatOfImath) {
    const auto check = [](std::uint32_t bits) {
        const auto value = std::bit_cast<float>(bits);
        ASSERT_EQ(nearest_half(value), imath_float_to_half(value)) << bits;
    };
    std::mt19937 random(1);
    for (int i = 0; i < 2'000'000; ++i)
        check(static_cast<std::uint32_t>(random()));
    // All half floats, the middles between neighbors, and the floats next to both.
    for (std::uint32_t bits = 0; bits < 0x10000; ++bits) {
        const auto exact =
            std::bit_cast<std::uint32_t>(imath_half_to_float(static_cast<std::uint16_t>(bits)));
        for (const std::uint32_t near : {0x0U, 0x1000U, 0x800U}) {
            check(exact + near);
            check(exact + near + 1);
            check(exact + near - 1);
        }
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
