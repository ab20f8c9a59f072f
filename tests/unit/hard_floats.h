// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/random.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Floats that are hard to print: of every size, next to powers of ten, denormal.
inline std::vector<float> hard_floats(std::size_t count) {
    std::vector<float> values = {
        0,      1,     -1,  0.1F, 1.0F / 3, 16777217.0F, 1e-45F, 1.1754944e-38F, 3.4028235e38F,
        -65504, 1e-4F, 1e9F};
    for (int power = -44; power <= 38; ++power) {
        const auto ten = static_cast<float>(std::pow(10.0, power));
        values.push_back(std::nextafterf(ten, 0));
        values.push_back(std::nextafterf(ten, 1e30F));
    }
    SampleRandom random(23);
    while (values.size() < count) {
        const auto x = std::bit_cast<float>(static_cast<std::uint32_t>(random.bits() >> 32));
        if (std::isfinite(x)) values.push_back(x);
    }
    values.resize(count);
    return values;
}

TONEWRIGHT_NAMESPACE_END
